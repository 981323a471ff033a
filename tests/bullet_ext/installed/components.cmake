# A component looks for what it needs and for nothing else: everything else is hidden.
#   cmake -DPREFIX=... -DSOURCE=... -DWORK=... -DCXX=... -P components.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
file(REMOVE_RECURSE ${WORK})
set(all assimp Boost CGAL fcl nlohmann_json OpenMP Torch)

# only(COMPONENTS SOURCE MODULE FORBIDDEN PACKAGES...): SOURCE builds and runs where of all packages
# only PACKAGES are found; neither it nor pkg-config's MODULE names a library like FORBIDDEN.
function(only components source module forbidden)
  string(REPLACE " " "_" folder "${WORK}/${components}")
  string(REGEX REPLACE "([a-z]+)" "FastCloth::\\1" targets "${components}")
  file(WRITE ${folder}/CMakeLists.txt "cmake_minimum_required(VERSION 3.24)
project(Only CXX)
find_package(FastCloth REQUIRED COMPONENTS ${components})
add_executable(program ${source})
target_link_libraries(program PRIVATE ${targets})
")
  set(hidden)
  foreach(package ${all})
    if(NOT package IN_LIST ARGN)
      list(APPEND hidden -DCMAKE_DISABLE_FIND_PACKAGE_${package}=TRUE)
    endif()
  endforeach()
  run("${components}: configure with only '${ARGN}'" works ${CMAKE_COMMAND} -G Ninja -S ${folder}
      -B ${folder}/b -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_CXX_COMPILER=${CXX} ${hidden})
  run("${components}: build" works ${CMAKE_COMMAND} --build ${folder}/b)
  run("${components}: run" works ${folder}/b/program)
  foreach(command "ldd ${folder}/b/program" "pkg-config --libs ${module}")
    run("${command}" works sh -c "${command}")
    message("${run_output}")
    if(run_output MATCHES "${forbidden}")
      message(FATAL_ERROR "'${command}' names ${CMAKE_MATCH_0}")
    endif()
  endforeach()
endfunction()

set(gpl "gmp|mpfr|CGAL|cholmod|umfpack|spqr")
file(WRITE ${WORK}/core.cpp "#include \"data/core/mesh.h\"
static_assert(__cplusplus >= 201703L, \"C++17 comes with the target\");
int main() { return cloth::undirected_edges(cloth::Faces(0, 3)).empty() ? 0 : 1; }
")
file(WRITE ${WORK}/body.cpp "#include \"data/body/body.h\"
int main() { return cloth::Body::load_default().faces()->rows() > 1000 ? 0 : 1; }
")
only("core" ${WORK}/core.cpp fastcloth-core "${gpl}|assimp|minizip|fcl|gomp|Bullet")
only("bullet" ${CMAKE_CURRENT_LIST_DIR}/programs/only_bullet.cpp fastcloth-bullet
     "${gpl}|assimp|minizip" fcl OpenMP)
only("bullet model" ${SOURCE}/demos/hello_cloth.cpp fastcloth "${gpl}|assimp|minizip" fcl OpenMP)
only("body" ${WORK}/body.cpp fastcloth-body "${gpl}|fcl|gomp|Bullet" assimp)
