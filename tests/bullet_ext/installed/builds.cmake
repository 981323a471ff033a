# Builds programs outside the tree with the flags FLAGS, by find_package or by both it and pkg-config,
# and runs them: what a program gets from the library and gives to it must not depend on how it is
# compiled.
#   cmake -DPREFIX=... -DSOURCE=... -DWORK=... -DCXX=... -DFLAGS=... [-DONLY_PASSES=ON] [-DPKG_CONFIG=ON]
#         -P builds.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
set(here ${CMAKE_CURRENT_LIST_DIR})
set(demos ${SOURCE}/demos)
set(sources ${here}/programs/passes_meshes.cpp ${here}/programs/passes_states.cpp)
if(NOT ONLY_PASSES)
  list(APPEND sources ${demos}/hello_cloth.cpp ${demos}/hello_tshirt.cpp ${demos}/external/main.cpp
       ${demos}/external/own_character.cpp)
endif()
set(modules_of_passes_meshes fastcloth-authoring)
set(modules_of_passes_states "fastcloth-bullet fastcloth-physics")
set(modules_of_hello_cloth fastcloth)
set(modules_of_hello_tshirt "fastcloth fastcloth-body")
set(modules_of_main fastcloth)
set(modules_of_own_character "fastcloth fastcloth-body")
set(arguments_of_hello_tshirt "01_01 5")
set(arguments_of_own_character "/usr/share/assimp/models/X/BCN_Epileptic.X \
${SOURCE}/data/assets/garments/cape.obj 0.39 1.0")

list(JOIN sources "|" joined)
run("configure" works ${CMAKE_COMMAND} -G Ninja -S ${here}/programs -B ${WORK}/build
    -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS}"
    "-DSOURCES=${joined}")
run("build" works ${CMAKE_COMMAND} --build ${WORK}/build --parallel 2)
foreach(source ${sources})
  get_filename_component(program ${source} NAME_WE)
  run("${program} by find_package" works sh -c "${WORK}/build/${program} ${arguments_of_${program}}")
  # The weights that it finds are the installed ones.
  if(program STREQUAL "main" AND
     NOT run_output MATCHES "weights ${PREFIX}/share/fastcloth/assets/weights")
    message(FATAL_ERROR "the example took its weights from elsewhere:\n${run_output}")
  endif()

  if(NOT PKG_CONFIG)
    continue()
  endif()
  run("${program}: build by pkg-config" works sh -c
      "${CXX} -std=c++17 ${FLAGS} ${source} -o ${WORK}/${program} \
       $(pkg-config --cflags --libs ${modules_of_${program}})")
  run("${program} by pkg-config" works sh -c
      "CLOTH_ASSETS=$(pkg-config --variable=assets fastcloth) \
       ${WORK}/${program} ${arguments_of_${program}}")
endforeach()
