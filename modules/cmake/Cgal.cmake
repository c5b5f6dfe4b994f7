# CGAL: headers only, GMP and MPFR behind its exact numbers. Its interval arithmetic needs -frounding-math, which its
# target brings along.
find_package(CGAL 5.5 REQUIRED QUIET)
