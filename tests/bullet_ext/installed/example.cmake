# Pastes the commands that demos/external/CMakeLists.txt gives, in a folder where no variable names
# another generator; the first ones, which build and install, are the tests' own.
#   cmake -DPREFIX=... -DSOURCE=... -DWORK=... -P example.cmake
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
file(STRINGS ${SOURCE}/demos/external/CMakeLists.txt commands REGEX "^#   cmake.*build/external")
list(LENGTH commands count)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "demos/external/CMakeLists.txt has ${count} commands instead of two")
endif()
unset(ENV{CMAKE_GENERATOR})
file(REMOVE_RECURSE ${WORK})
foreach(command ${commands})
  string(REGEX REPLACE "^# *" "" command "${command}")
  string(REPLACE "$PWD/build/installed" "${PREFIX}" command "${command}")
  string(REPLACE "build/external" "${WORK}" command "${command}")
  run("${command}" works sh -c "cd ${SOURCE} && ${command}")
endforeach()
