# Wrong uses of the installed package fail with a message that helps.
#   cmake -DPREFIX=... -DSOURCE=... -DWORK=... -DCXX=... -P refusals.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
file(REMOVE_RECURSE ${WORK})
set(compile ${CXX} -std=c++17 -fsyntax-only -I${PREFIX}/include/fastcloth -I/usr/include/eigen3
    -I/usr/include/bullet)
set(name -DEigen=FastClothEigen)
set(layout ${name} -DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16)
set(example ${SOURCE}/demos/external/main.cpp)
file(WRITE ${WORK}/core.cpp "#include \"data/core/types.h\"\n")
foreach(flags "" "-O0" "-march=native" "-mavx512f;-mfma" "-march=x86-64-v3;-DEIGEN_MAX_ALIGN_BYTES=64"
        "-DEIGEN_MAX_STATIC_ALIGN_BYTES=16" "-DEIGEN_MAX_ALIGN_BYTES=0")
  run("another layout of Eigen's memory: ${flags}"
      "static assertion failed: FastCloth needs -DEIGEN_MAX_ALIGN_BYTES=64"
      ${compile} ${name} ${flags} ${WORK}/core.cpp)
  run("the layout: ${flags}" works ${compile} ${flags} ${layout}
      ${WORK}/core.cpp)
endforeach()
run("another layout in the example" "static assertion failed: FastCloth needs" ${compile} ${example})
run("double precision" "single precision"
    ${compile} ${layout} -DBT_USE_DOUBLE_PRECISION ${example})

run("Eigen by its own name" "FastCloth needs -DEigen=FastClothEigen.*Remedy: link its CMake targets"
    ${compile} ${layout} -UEigen ${WORK}/core.cpp)
run("indices of 32 bits" "Eigen's own index type. Remedy: leave -DEIGEN_DEFAULT_DENSE_INDEX_TYPE out"
    ${compile} ${layout} -DEIGEN_DEFAULT_DENSE_INDEX_TYPE=int ${WORK}/core.cpp)
run("matrices by rows" "by columns. Remedy: leave -DEIGEN_DEFAULT_TO_ROW_MAJOR out"
    ${compile} ${layout} -DEIGEN_DEFAULT_TO_ROW_MAJOR ${WORK}/core.cpp)
run("containers in debug mode" "no debug mode. Remedy: leave -D_GLIBCXX_DEBUG out"
    ${compile} ${layout} -D_GLIBCXX_DEBUG ${WORK}/core.cpp)
run("checked indices" works ${compile} ${layout} -D_GLIBCXX_ASSERTIONS ${WORK}/core.cpp)
file(WRITE ${WORK}/old/Eigen/Core "#define EIGEN_WORLD_VERSION 3\n#define EIGEN_MAJOR_VERSION 3\n")
file(WRITE ${WORK}/old/Eigen/Geometry "")
run("an older Eigen" "FastCloth needs Eigen 3.4. Remedy: "
    ${CXX} -std=c++17 -fsyntax-only -I${WORK}/old -I${PREFIX}/include/fastcloth ${layout} ${WORK}/core.cpp)

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
file(WRITE ${WORK}/old/Eigen3Config.cmake "add_library(Eigen3::Eigen INTERFACE IMPORTED)\n")
file(WRITE ${WORK}/old/Eigen3ConfigVersion.cmake "set(PACKAGE_VERSION 3.3.9)
if(NOT PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION)
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
")
find("an older Eigen3" "component core needs Eigen3 3.4" "REQUIRED COMPONENTS core"
     -DEigen3_DIR=${WORK}/old -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF
     -DCMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH=OFF -DCMAKE_MAKE_PROGRAM=${NINJA})
find("an unknown optional component" works "OPTIONAL_COMPONENTS havok body"
     -DCMAKE_DISABLE_FIND_PACKAGE_assimp=TRUE)

file(WRITE ${WORK}/part/CMakeLists.txt "cmake_minimum_required(VERSION 3.24)
project(Game CXX)
add_subdirectory(${SOURCE} fastcloth)
")
run("a part of another build" "cannot be a part of another build.*Remedy: install it"
    ${CMAKE_COMMAND} -G Ninja -S ${WORK}/part -B ${WORK}/part/b -DCMAKE_CXX_COMPILER=${CXX})
