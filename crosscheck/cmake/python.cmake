# The Python module, built on demand: ./dynwitness python. It is linked from floors that are MOVABLE, and
# shows none of their names to other modules.
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

file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/crosscheck/python/*.cpp)
pybind11_add_module(dynwitness_python EXCLUDE_FROM_ALL MODULE NO_EXTRAS ${sources})
set_target_properties(dynwitness_python PROPERTIES OUTPUT_NAME _core
  LIBRARY_OUTPUT_DIRECTORY ${DYNWITNESS_PYTHON_FOLDER})
target_compile_options(dynwitness_python PRIVATE -Wall -Wextra)
target_compile_definitions(dynwitness_python PRIVATE DYNWITNESS_VERSION="${PROJECT_VERSION}")
target_include_directories(dynwitness_python SYSTEM PRIVATE ${EIGEN3_INCLUDE_DIRS})
target_link_libraries(dynwitness_python PRIVATE
  dynwitness::scene dynwitness::symbolic dynwitness::recursive dynwitness::system dynwitness::inputs
  dynwitness::scalars dynwitness::kernel
  Eigen3::Eigen fmt::fmt)
target_link_options(dynwitness_python PRIVATE -Wl,--exclude-libs,ALL)
