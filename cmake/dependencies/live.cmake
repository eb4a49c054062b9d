# Debian's cpp-httplib brings no CMake package on Debian 12. The sizes of its classes depend on the definitions with which it
# was compiled.
lodeline_find_library(httplib::httplib httplib.h cpp-httplib)
if(TARGET httplib::httplib)
  set_target_properties(httplib::httplib PROPERTIES INTERFACE_COMPILE_DEFINITIONS
                        "CPPHTTPLIB_OPENSSL_SUPPORT;CPPHTTPLIB_ZLIB_SUPPORT;CPPHTTPLIB_BROTLI_SUPPORT")
endif()
