# `cmake --install`: programs, headers and find_package(Spikeloop).
include(CMakePackageConfigHelpers)
install(EXPORT SpikeloopTargets NAMESPACE Spikeloop::
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Spikeloop)
configure_package_config_file(cmake/SpikeloopConfig.cmake.in
  ${CMAKE_BINARY_DIR}/SpikeloopConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Spikeloop)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SpikeloopConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SpikeloopConfig.cmake
              ${CMAKE_BINARY_DIR}/SpikeloopConfigVersion.cmake
              cmake/SpikeloopPlugin.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Spikeloop)
