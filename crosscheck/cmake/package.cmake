# A Debian package of what is installed (install.cmake): cpack --config build/CPackConfig.cmake, or
# ./dynwitness package. Which libraries it depends on is read off the programs, and the modules of engines.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dynwitness)
set(CPACK_PACKAGE_CONTACT "The dynwitness authors <dynwitness@localhost>")  # a package has to have one
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "independent computations of robot dynamics testify against each other")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/package)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gcc, gnuplot-nox, python3")  # kernels, charts, helpers for engines
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libeigen3-dev, nodejs")  # recursive/ from C++, MuJoCo of today
include(CPack)

# what is installed, without the tests
add_custom_target(dynwitness_programs)
add_dependencies(dynwitness_programs dynwitness_cli ${programs} ${reader_programs}
                 dynwitness_scene dynwitness_recursive dynwitness_symbolic)
if(TARGET dynwitness_pages)
  add_dependencies(dynwitness_programs dynwitness_pages)
endif()
