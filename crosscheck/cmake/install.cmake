# Install rules: the program, the libraries with their headers, the data, and a CMake package, so
# that
#
#     find_package(dynwitness REQUIRED)
#     target_link_libraries(my_program PRIVATE dynwitness::recursive)
#
# works in another project. Included last by the top-level CMakeLists.txt, after the targets
# dynwitness_scene, dynwitness_recursive and dynwitness_symbolic (whose EXPORT_NAME is without the
# prefix, and whose installed include folder is the one below) and dynwitness_cli.
#
# The floors of crosscheck/ are installed as the program: as libraries they would ask every
# user for all that they link, and nobody has wanted that so far.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(headers ${CMAKE_INSTALL_INCLUDEDIR}/dynwitness)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/dynwitness)
set(data ${CMAKE_INSTALL_DATADIR}/dynwitness)

foreach(library scene recursive symbolic)
  install(TARGETS dynwitness_${library} EXPORT dynwitnessTargets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${library} DESTINATION ${headers}
          FILES_MATCHING PATTERN "*.hpp" PATTERN "*.inc" PATTERN "LICENSE"
          PATTERN "toml_file.hpp" EXCLUDE)  # needs toml++, which users do not
endforeach()

set(programs ${DYNWITNESS_PROGRAMS})
list(TRANSFORM programs REPLACE "(.+)" "dynwitness_\\1_program")
install(TARGETS dynwitness_cli ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
get_property(engine_modules GLOBAL PROPERTY DYNWITNESS_ENGINE_MODULES)
install(TARGETS ${engine_modules} LIBRARY DESTINATION lib/dynwitness)  # where programs in bin/ look
if(reader_programs)
  install(TARGETS ${reader_programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/scenes ${PROJECT_SOURCE_DIR}/data/reference
                  ${PROJECT_SOURCE_DIR}/data/audit ${PROJECT_SOURCE_DIR}/data/engines
                  ${PROJECT_SOURCE_DIR}/data/golden ${PROJECT_SOURCE_DIR}/data/hardest
                  ${PROJECT_SOURCE_DIR}/data/museum
        DESTINATION ${data})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CITATION.cff
        DESTINATION ${CMAKE_INSTALL_DOCDIR})

# the man page and completion, of what the programs say of themselves
find_program(PYTHON3 NAMES python3)
if(PYTHON3)
  set(pages ${PROJECT_BINARY_DIR}/pages)
  set(writes ${PROJECT_SOURCE_DIR}/crosscheck/cli/pages.py)
  add_custom_command(OUTPUT ${pages}/dynwitness.1 ${pages}/dynwitness.bash ${pages}/_dynwitness
    COMMAND ${PYTHON3} ${writes} $<TARGET_FILE:dynwitness_cli> ${PROJECT_SOURCE_DIR}/crosscheck/cli/commands.txt ${pages}
    DEPENDS ${writes} dynwitness_cli ${programs} VERBATIM)
  add_custom_target(dynwitness_pages ALL DEPENDS ${pages}/dynwitness.1 ${pages}/dynwitness.bash)
  install(FILES ${pages}/dynwitness.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${pages}/dynwitness.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          RENAME dynwitness)
  # zsh looks here; for what packages bring, Debian's looks in a folder of its own
  install(FILES ${pages}/_dynwitness DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  if(EXISTS /etc/debian_version)
    install(FILES ${pages}/_dynwitness DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  endif()
endif()

install(EXPORT dynwitnessTargets NAMESPACE dynwitness:: DESTINATION ${package})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/dynwitnessConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/dynwitnessConfig.cmake
                              INSTALL_DESTINATION ${package} PATH_VARS data)
# before 1.0 a minor version may change the interface
write_basic_package_version_file(${PROJECT_BINARY_DIR}/dynwitnessConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/dynwitnessConfig.cmake
              ${PROJECT_BINARY_DIR}/dynwitnessConfigVersion.cmake DESTINATION ${package})
