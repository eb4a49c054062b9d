# `make package`: a Debian package with the program, the libraries, the headers and the CMake package, and one with the
# Python module.
set(CPACK_GENERATOR DEB)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # `lodeline_product` is enough
set(CPACK_PACKAGE_NAME lodeline)
set(CPACK_PACKAGE_VENDOR "Lodeline")
set(CPACK_PACKAGE_CONTACT "The Lodeline authors <lodeline@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# What the program needs is read from its binary; what find_package(lodeline) needs is only recommended.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS
    "libeigen3-dev, libceres-dev, libapriltag-dev, libopencv-core-dev, libopencv-imgcodecs-dev, libopencv-calib3d-dev, libopencv-video-dev, \
libyaml-cpp-dev, libfmt-dev, zlib1g-dev, libdeflate-dev, libtbb-dev, libgeographiclib-dev, libproj-dev, libxml2-dev, \
libembree-dev, libavformat-dev, libavcodec-dev, libswscale-dev, libbz2-dev, liblz4-dev, libzstd-dev, libsqlite3-dev, libcpp-httplib-dev, gnuplot-nox")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "survex, therion, qgis")
# Two packages: what has no component is the package `lodeline`.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME lodeline)
if(LODELINE_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python module of Lodeline")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lodeline)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  math(EXPR next "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-matplotlib)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS lodeline)
endif()
include(CPack)
