# OpenCV by its parts: Debian's config file belongs to a package that draws in the whole library.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(part core imgproc video)
  find_library(OPENCV_${part} opencv_${part} REQUIRED)
  if(NOT TARGET OpenCv::${part})
    add_library(OpenCv::${part} UNKNOWN IMPORTED)
    set_target_properties(OpenCv::${part} PROPERTIES IMPORTED_LOCATION ${OPENCV_${part}}
      INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
  endif()
endforeach()
