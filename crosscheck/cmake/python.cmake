# The Python module, built on demand: ./dynwitness python. What it needs of the floors is compiled once more
# as code that can be moved (-fPIC), which programs do without; at -O1, since all that is done a state is in
# crosscheck/python/ itself and in the scene's compiled kernel.
#   dynwitness_python  the target; none where pybind11 or Python's headers are missing
set(DYNWITNESS_PYTHON_FOLDER ${PROJECT_BINARY_DIR}/python/dynwitness)
if(NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)  # Debian's, which its NumPy and pybind11 belong to
endif()
set(PYBIND11_FINDPYTHON ON)
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development.Module)
if(Python_FOUND)
  # pip's pybind11 says where it is; Debian's stands where CMake looks
  execute_process(COMMAND ${Python_EXECUTABLE} -m pybind11 --cmakedir
                  OUTPUT_VARIABLE pybind11_HINT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
find_package(pybind11 2.10 QUIET CONFIG HINTS ${pybind11_HINT})
if(NOT pybind11_FOUND OR NOT Python_FOUND)
  return()
endif()

# A floor once more, its COOL_FILES, which come as objects, among them.
function(dynwitness_movable FLOOR)
  get_target_property(sources dynwitness_${FLOOR} SOURCES)
  list(FILTER sources EXCLUDE REGEX "TARGET_OBJECTS")
  if(TARGET dynwitness_${FLOOR}_cool)
    get_target_property(cool dynwitness_${FLOOR}_cool SOURCES)
    list(APPEND sources ${cool})
  endif()
  list(FILTER sources EXCLUDE REGEX "kernel/(controller|code)_")  # code for controllers is the program's
  add_library(dynwitness_${FLOOR}_movable STATIC EXCLUDE_FROM_ALL ${sources})
  foreach(property COMPILE_DEFINITIONS COMPILE_OPTIONS INCLUDE_DIRECTORIES)
    get_target_property(value dynwitness_${FLOOR} ${property})
    if(value)
      set_target_properties(dynwitness_${FLOOR}_movable PROPERTIES ${property} "${value}")
    endif()
  endforeach()
  get_target_property(linked dynwitness_${FLOOR} LINK_LIBRARIES)
  list(REMOVE_ITEM linked dynwitness::recursive)  # headers, and the floor below as it stands
  list(TRANSFORM linked REPLACE "^dynwitness::(scene|symbolic|system|inputs|scalars|kernel)$" "dynwitness_\\1_movable")
  target_link_libraries(dynwitness_${FLOOR}_movable PUBLIC ${linked})
  set_target_properties(dynwitness_${FLOOR}_movable PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
    UNITY_BUILD ${DYNWITNESS_TOGETHER} UNITY_BUILD_BATCH_SIZE 8)
  target_compile_features(dynwitness_${FLOOR}_movable PUBLIC cxx_std_17)
  target_compile_options(dynwitness_${FLOOR}_movable PRIVATE -O1)
  target_include_directories(dynwitness_${FLOOR}_movable PUBLIC ${PROJECT_SOURCE_DIR})
endfunction()
foreach(floor scene symbolic system inputs scalars kernel)
  dynwitness_movable(${floor})
endforeach()

file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/crosscheck/python/*.cpp)
pybind11_add_module(dynwitness_python EXCLUDE_FROM_ALL MODULE NO_EXTRAS ${sources})
set_target_properties(dynwitness_python PROPERTIES OUTPUT_NAME _core
  LIBRARY_OUTPUT_DIRECTORY ${DYNWITNESS_PYTHON_FOLDER})
target_compile_options(dynwitness_python PRIVATE -Wall -Wextra)
target_compile_definitions(dynwitness_python PRIVATE DYNWITNESS_VERSION="${PROJECT_VERSION}")
target_include_directories(dynwitness_python SYSTEM PRIVATE ${EIGEN3_INCLUDE_DIRS})
target_link_libraries(dynwitness_python PRIVATE dynwitness_kernel_movable Eigen3::Eigen fmt::fmt)
