# Installs the libraries to a folder of their own and builds demos/external against them, with
# find_package and with pkg-config; wrong uses must fail with a message that helps.
#   cmake -DBUILD=... -DSOURCE=... -DWORK=... -DCXX=... -P installed_package.cmake
function(run what expected)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(expected STREQUAL "works" AND NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed:\n${output}")
  elseif(NOT expected STREQUAL "works" AND (result EQUAL 0 OR NOT output MATCHES "${expected}"))
    message(FATAL_ERROR "${what} did not fail with '${expected}':\n${output}")
  endif()
  message("${what}: as expected")
endfunction()

set(prefix ${WORK}/prefix)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
run("install" works ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})

set(configure ${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/demos/external -B ${WORK}/external
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Release)
run("configure" works ${configure})
run("build" works ${CMAKE_COMMAND} --build ${WORK}/external)
run("the example" works ${WORK}/external/example)
# The weights that it finds are the installed ones.
execute_process(COMMAND ${WORK}/external/example OUTPUT_VARIABLE output)
if(NOT output MATCHES "weights ${prefix}/share/fastcloth/assets/weights")
  message(FATAL_ERROR "the example took its weights from elsewhere:\n${output}")
endif()

run("an example in double precision" "single precision" ${CXX} -std=c++17 -fsyntax-only
    -DBT_USE_DOUBLE_PRECISION -I${prefix}/include/fastcloth -I/usr/include/eigen3
    -I/usr/include/bullet ${SOURCE}/demos/external/main.cpp)

file(WRITE ${WORK}/wrong/CMakeLists.txt "cmake_minimum_required(VERSION 3.24)
project(Wrong CXX)
find_package(FastCloth REQUIRED COMPONENTS havok)
")
run("an unknown component" "no component havok" ${CMAKE_COMMAND} -S ${WORK}/wrong -B ${WORK}/wrong/b
    -DCMAKE_PREFIX_PATH=${prefix})

file(GLOB_RECURSE pc ${prefix}/fastcloth.pc)
get_filename_component(pc_folder ${pc} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${pc_folder})
run("pkg-config" works sh -c
    "${CXX} -std=c++17 ${SOURCE}/demos/external/main.cpp $(pkg-config --cflags --libs fastcloth) \
     -o ${WORK}/by_pkg_config && \
     CLOTH_ASSETS=$(pkg-config --variable=assets fastcloth) ${WORK}/by_pkg_config")
