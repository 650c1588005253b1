# The witnesses and readers that need an engine which may be absent: MuJoCo, DART, Orocos KDL.
# Included by the top-level CMakeLists.txt after the targets dynwitness_witnesses and
# dynwitness_readers, among whose sources is one file an engine; without its engine a file is a stub,
# which reports name as absent.
#
#     apt-get install libmujoco-dev libdart-utils-urdf-dev liborocos-kdl-dev
option(DYNWITNESS_ENGINES "look for MuJoCo, DART and Orocos KDL" ON)

# dynwitness_engine(FLOOR FILE DEFINITION TARGET...): compile crosscheck/FLOOR/FILE with the engine
function(dynwitness_engine FLOOR FILE DEFINITION)
  set(source crosscheck/${FLOOR}/${FILE})
  set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS ${DEFINITION})
  foreach(target ${ARGN})
    get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
    # the compiler's own folders must not come again in another order: <cstdlib> would not compile
    list(TRANSFORM folders REPLACE "/$" "")
    list(REMOVE_ITEM folders folders-NOTFOUND ${CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES})
    set_property(SOURCE ${source} APPEND PROPERTY INCLUDE_DIRECTORIES ${folders})
    target_link_libraries(dynwitness_${FLOOR} PRIVATE $<LINK_ONLY:${target}>)
  endforeach()
endfunction()

if(DYNWITNESS_ENGINES)
  # 3.0 changed how a model is given to the parser, and the layout of M
  find_package(mujoco 2.2...<3 QUIET)
  if(TARGET mujoco::mujoco)
    dynwitness_engine(witnesses mujoco.cpp DYNWITNESS_HAS_MUJOCO mujoco::mujoco)
    dynwitness_engine(readers mujoco_reader.cpp DYNWITNESS_HAS_MUJOCO mujoco::mujoco)
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
    dynwitness_engine(witnesses dart.cpp DYNWITNESS_HAS_DART dart-utils-urdf)
    dynwitness_engine(readers dart_reader.cpp DYNWITNESS_HAS_DART dart-utils-urdf)
  endif()

  pkg_check_modules(KDL QUIET IMPORTED_TARGET orocos-kdl>=1.5)
  if(TARGET PkgConfig::KDL)
    dynwitness_engine(witnesses kdl.cpp DYNWITNESS_HAS_KDL PkgConfig::KDL)
  endif()
endif()

foreach(engine MuJoCo=mujoco::mujoco DART=dart-utils-urdf KDL=PkgConfig::KDL)
  string(REPLACE "=" ";" engine ${engine})
  list(POP_FRONT engine name)
  if(TARGET ${engine})
    message(STATUS "Witness ${name}: found")
  else()
    message(STATUS "Witness ${name}: not found, the report will say so")
  endif()
endforeach()
