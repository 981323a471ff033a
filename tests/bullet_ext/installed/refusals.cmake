# Wrong uses of the installed package fail with a message that helps.
#   cmake -DPREFIX=... -DSOURCE=... -DWORK=... -DCXX=... -P refusals.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
file(REMOVE_RECURSE ${WORK})
set(compile ${CXX} -std=c++17 -fsyntax-only -I${PREFIX}/include/fastcloth -I/usr/include/eigen3
    -I/usr/include/bullet)
set(layout -DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16)
set(example ${SOURCE}/demos/external/main.cpp)
file(WRITE ${WORK}/core.cpp "#include \"data/core/types.h\"\n")
foreach(flags "" "-O0" "-march=native" "-mavx512f;-mfma" "-march=x86-64-v3;-DEIGEN_MAX_ALIGN_BYTES=64"
        "-DEIGEN_MAX_STATIC_ALIGN_BYTES=16" "-DEIGEN_MAX_ALIGN_BYTES=0")
  run("another layout of Eigen's memory: ${flags}"
      "static assertion failed: FastCloth needs -DEIGEN_MAX_ALIGN_BYTES=64"
      ${compile} ${flags} ${WORK}/core.cpp)
  run("the layout: ${flags}" works ${compile} ${flags} ${layout}
      ${WORK}/core.cpp)
endforeach()
run("another layout in the example" "static assertion failed: FastCloth needs" ${compile} ${example})
run("double precision" "single precision"
    ${compile} ${layout} -DBT_USE_DOUBLE_PRECISION ${example})

function(find what expected arguments)
  file(WRITE ${WORK}/CMakeLists.txt "cmake_minimum_required(VERSION 3.24)
project(Wrong CXX)
find_package(FastCloth ${arguments})
")
  file(REMOVE_RECURSE ${WORK}/b)
  run("${what}" "${expected}" ${CMAKE_COMMAND} -G Ninja -S ${WORK} -B ${WORK}/b
      -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_CXX_COMPILER=${CXX} ${ARGN})
endfunction()
find("an unknown component" "no component havok" "REQUIRED COMPONENTS havok")
find("files without assimp" "component files needs assimp" "REQUIRED COMPONENTS body"
     -DCMAKE_DISABLE_FIND_PACKAGE_assimp=TRUE)
find("authoring without CGAL" "component authoring needs CGAL" "REQUIRED COMPONENTS authoring"
     -DCMAKE_DISABLE_FIND_PACKAGE_CGAL=TRUE)
find("model without FCL" "component collision needs fcl" "REQUIRED COMPONENTS model"
     -DCMAKE_DISABLE_FIND_PACKAGE_fcl=TRUE)
find("an unknown optional component" works "OPTIONAL_COMPONENTS havok body"
     -DCMAKE_DISABLE_FIND_PACKAGE_assimp=TRUE)
