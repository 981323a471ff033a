#pragma once

#include <string>

namespace cloth {

/// Runs this program `count` times on this machine, as processes that train together: each gets
/// RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT. SIGINT and SIGTERM are handed on; if one fails,
/// the others are stopped; if this process is killed, they stop as if told to.
/// @param port  that the first one listens on
/// @return  0, or the exit status of the first one that failed; 128 and more: the signal that ended
///          it
/// @throws ArgumentError if the system starts no more processes
int run_local_processes(int count, char** arguments, int port);

}  // namespace cloth
