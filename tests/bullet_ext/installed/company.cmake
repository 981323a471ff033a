# A program whose other libraries use Eigen with its defaults, compiled with the flags FLAGS: they and
# FastCloth work side by side, linked in any order, or with cloth in a shared library.
#   cmake -DPREFIX=... -DWORK=... -DCXX=... -DFLAGS=... -P company.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
file(REMOVE_RECURSE ${WORK})
run("configure" works ${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR}/programs/company -B ${WORK}
    -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run("build" works ${CMAKE_COMMAND} --build ${WORK} --parallel 2)
foreach(program cloth_first cloth_last with_plugin)
  run("${program}" works ${WORK}/${program})
endforeach()
# Arrays of the one Eigen do not get into functions of the other.
run("an Eigen array handed over" "undefined reference to .mean\\(FastClothEigen::Matrix"
    ${CMAKE_COMMAND} --build ${WORK} --target hands_over_eigen)
