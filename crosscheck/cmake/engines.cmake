# Engines by others: Simbody, MuJoCo, DART, Orocos KDL, kdl_parser, sdformat; all but Simbody may be
# absent. Their witnesses, with what is called raw in charts, are modules, lib/dynwitness/engine-NAME.so,
# which programs load when a witness is first asked for (crosscheck/witnesses/engine_modules.hpp).
# Included by the top-level CMakeLists.txt after the target dynwitness_readers, among whose sources is one
# file an engine; without its engine a file is a stub, which reports name as absent.
#
#     apt-get install libmujoco-dev libdart-utils-urdf-dev liborocos-kdl-dev libkdl-parser-dev libsdformat-dev
option(DYNWITNESS_ENGINES "look for MuJoCo, DART, Orocos KDL, kdl_parser and sdformat" ON)

# dynwitness_engine_folders(OUT TARGET): where its headers are. The compiler's own folders must not come
# again in another order: <cstdlib> would not compile.
function(dynwitness_engine_folders OUT TARGET)
  get_target_property(folders ${TARGET} INTERFACE_INCLUDE_DIRECTORIES)
  list(TRANSFORM folders REPLACE "/$" "")
  list(REMOVE_ITEM folders folders-NOTFOUND ${CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES})
  set(${OUT} ${folders} PARENT_SCOPE)
endfunction()

# What a module calls of the floors is in the program that loads it, which shows its names for that
# (shown_to_engines.list).
target_link_options(dynwitness_witnesses INTERFACE
  -Wl,--dynamic-list=${CMAKE_CURRENT_LIST_DIR}/shown_to_engines.list)

# dynwitness_engine_module(NAME SOURCES FILE... FOLDERS FOLDER... LINK LIBRARY...)
function(dynwitness_engine_module NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;FOLDERS;LINK" ${ARGN})
  set(target dynwitness_engine_${NAME})
  list(TRANSFORM ARG_SOURCES PREPEND crosscheck/)
  add_library(${target} MODULE ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME engine-${NAME} SUFFIX .so
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/dynwitness)
  dynwitness_make_movable(${target})
  target_compile_features(${target} PRIVATE cxx_std_17)
  target_compile_options(${target} PRIVATE -Wall -Wextra $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_compile_definitions(${target} PRIVATE DYNWITNESS_VERSION="${PROJECT_VERSION}")
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  target_include_directories(${target} SYSTEM PRIVATE ${ARG_FOLDERS})  # where others' warnings stay
  target_link_libraries(${target} PRIVATE Boost::headers Eigen3::Eigen fmt::fmt)
  foreach(library ${ARG_LINK})
    target_link_libraries(${target} PRIVATE $<LINK_ONLY:${library}>)
  endforeach()
  # what is called of the program is looked for when the module is loaded, which fails where it is not there
  target_link_options(${target} PRIVATE -Wl,-z,now)
  dynwitness_use_precompiled(outside_movable ${target})
  add_dependencies(dynwitness_witnesses ${target})
  set_property(GLOBAL APPEND PROPERTY DYNWITNESS_ENGINE_MODULES ${target})
  set_property(GLOBAL APPEND_STRING PROPERTY DYNWITNESS_ENGINE_NAMES " ${NAME}")
endfunction()

# dynwitness_engine_reader(FILE DEFINITION TARGET): compile crosscheck/readers/FILE with the engine
function(dynwitness_engine_reader FILE DEFINITION TARGET)
  dynwitness_engine_folders(folders ${TARGET})
  set_source_files_properties(crosscheck/readers/${FILE} PROPERTIES
    COMPILE_DEFINITIONS ${DEFINITION} INCLUDE_DIRECTORIES "${folders}")
  target_link_libraries(dynwitness_readers PRIVATE $<LINK_ONLY:${TARGET}>)
endfunction()

dynwitness_engine_module(simbody
  SOURCES witnesses/simbody.cpp chart/raw_simbody.cpp chart/raw_simbody_calls.cpp
  FOLDERS ${Simbody_INCLUDE_DIR} LINK ${Simbody_LIBRARIES})
if(DYNWITNESS_ENGINES)
  # 3.0 changed how a model is given to the parser, and the layout of M
  find_package(mujoco 2.2...<3 QUIET)
  if(TARGET mujoco::mujoco)
    dynwitness_engine_folders(folders mujoco::mujoco)
    dynwitness_engine_module(mujoco SOURCES witnesses/mujoco.cpp chart/raw_mujoco_calls.cpp
      FOLDERS ${folders} LINK mujoco::mujoco)
    dynwitness_engine_reader(mujoco_reader.cpp DYNWITNESS_HAS_MUJOCO mujoco::mujoco)
  endif()

  # not by DART's CMake package, which adds -DBOOST_TEST_DYN_LINK to every target of a project
  pkg_check_modules(DART QUIET dart>=6.12)
  find_path(DART_FOLDER dart/utils/urdf/DartLoader.hpp)
  find_library(DART_LIBRARY dart)
  find_library(DART_URDF_LIBRARY dart-utils-urdf)
  if(DART_FOUND AND DART_FOLDER AND DART_LIBRARY AND DART_URDF_LIBRARY)
    add_library(dart-utils-urdf SHARED IMPORTED)
    set_target_properties(dart-utils-urdf PROPERTIES
      IMPORTED_LOCATION ${DART_URDF_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${DART_FOLDER}
      INTERFACE_LINK_LIBRARIES ${DART_LIBRARY})
    dynwitness_engine_folders(folders dart-utils-urdf)
    dynwitness_engine_module(dart SOURCES witnesses/dart.cpp chart/raw_dart.cpp
      FOLDERS ${folders} LINK dart-utils-urdf)
    dynwitness_engine_reader(dart_reader.cpp DYNWITNESS_HAS_DART dart-utils-urdf)
  endif()

  pkg_check_modules(KDL QUIET IMPORTED_TARGET orocos-kdl>=1.5)
  if(TARGET PkgConfig::KDL)
    dynwitness_engine_folders(folders PkgConfig::KDL)
    dynwitness_engine_module(kdl SOURCES witnesses/kdl.cpp FOLDERS ${folders} LINK PkgConfig::KDL)
  endif()

  # Readers that are programs of their own, started for a file: dynwitness would load their
  # libraries (Python, ROS, ICU) at every start. The program looks for them beside itself.
  function(dynwitness_reader_program NAME)
    set(target dynwitness_${NAME}_reader)
    add_executable(${target} crosscheck/readers/programs/${NAME}_reader.cpp)
    set_target_properties(${target} PROPERTIES OUTPUT_NAME dynwitness-reader-${NAME}
      RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
    target_compile_options(${target} PRIVATE -Wall -Wextra -O1)
    target_compile_features(${target} PRIVATE cxx_std_17)
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${target} PRIVATE ${ARGN} Eigen3::Eigen nlohmann_json::nlohmann_json)
    set_property(GLOBAL APPEND PROPERTY DYNWITNESS_READER_PROGRAMS ${target})
  endfunction()
  # not by its pkg-config file, which asks for a pluginlib.pc that Debian has not
  find_path(KDL_PARSER_FOLDER kdl_parser/kdl_parser.hpp)
  find_library(KDL_PARSER_LIBRARY kdl_parser)
  pkg_check_modules(URDF_MODEL QUIET IMPORTED_TARGET urdfdom_headers)
  if(TARGET PkgConfig::KDL AND TARGET PkgConfig::URDF_MODEL AND KDL_PARSER_FOLDER AND KDL_PARSER_LIBRARY)
    add_library(kdl_parser SHARED IMPORTED)
    set_target_properties(kdl_parser PROPERTIES IMPORTED_LOCATION ${KDL_PARSER_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${KDL_PARSER_FOLDER})
    dynwitness_reader_program(kdl kdl_parser PkgConfig::KDL PkgConfig::URDF_MODEL)
    file(STRINGS ${KDL_PARSER_FOLDER}/../share/kdl_parser/package.xml version REGEX "<version>" LIMIT_COUNT 1)
    string(REGEX REPLACE ".*<version>([^<]*)<.*" "\\1" version "${version}")
    target_compile_definitions(dynwitness_kdl_reader PRIVATE KDL_PARSER_VERSION="${version}")
  endif()
  pkg_check_modules(SDFORMAT QUIET IMPORTED_TARGET sdformat12)  # later ones renamed their mathematics
  if(TARGET PkgConfig::SDFORMAT)
    dynwitness_reader_program(sdformat PkgConfig::SDFORMAT)
  endif()
endif()

get_property(names GLOBAL PROPERTY DYNWITNESS_ENGINE_NAMES)
set_source_files_properties(crosscheck/witnesses/engine_modules.cpp PROPERTIES
  COMPILE_DEFINITIONS "DYNWITNESS_ENGINE_MODULES=\"${names}\"")

foreach(engine MuJoCo=mujoco::mujoco DART=dart-utils-urdf KDL=PkgConfig::KDL kdl_parser=kdl_parser
               sdformat=PkgConfig::SDFORMAT)
  string(REPLACE "=" ";" engine ${engine})
  list(POP_FRONT engine name)
  if(TARGET ${engine})
    message(STATUS "Engine ${name}: found")
  else()
    message(STATUS "Engine ${name}: not found, reports will say so")
  endif()
endforeach()
