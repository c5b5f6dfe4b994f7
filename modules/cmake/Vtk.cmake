# The one place that names the parts of VTK that Vernier uses: common data, marching cubes and XML files, never its
# windows (no OpenGL, no X11). Its headers are seen by the targets that link VERNIER_VTK, and by nothing else; libvernier
# itself links none of it.
find_package(VTK 9.1 REQUIRED COMPONENTS CommonCore CommonDataModel CommonExecutionModel FiltersCore IOXML)
set(VERNIER_VTK VTK::CommonCore VTK::CommonDataModel VTK::CommonExecutionModel VTK::FiltersCore VTK::IOXML)
