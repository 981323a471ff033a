#pragma once

#include <atomic>
#include <iostream>
#include <string>

namespace cloth {

/// How a program of its own runs a training.
struct TrainingProgram {
    std::string name;     ///< for messages
    std::string out;      ///< folder of the training
    int nice = 0;         ///< priority, 0 to 19: the larger, the more it gives way
    bool resume = false;  ///< goes on with what is in the folder
    bool writes = true;   ///< false: another process writes the files of this training, and speaks
};

/// Lowers the priority.
/// @throws ArgumentError if the folder has files of a training that would be overwritten: one of
///         days must not be lost because an option was forgotten; or if `nice` is out of range;
///         LoadError if the folder cannot be made
void begin_training(const TrainingProgram& program);

/// True after Ctrl-C or SIGTERM, from the first call on; the second signal ends the program at
/// once.
const std::atomic<bool>& stop_on_signals();

/// Makes a trainer, resumes it if that is asked for, and runs it until its end or a signal.
template <typename Make>
void run_training(const TrainingProgram& program, const Make& make) {
    begin_training(program);
    auto trainer = make();
    if (program.resume && !trainer.resume() && program.writes)
        std::cerr << program.name << ": no checkpoint in " << program.out << ", starting anew\n";
    const std::atomic<bool>& stop = stop_on_signals();
    trainer.run(stop);
    if (!program.writes) return;
    if (stop) std::cerr << program.name << ": stopped; --resume goes on\n";
    std::cerr << program.name << ": weights in " << program.out << "/weights.safetensors\n";
}

}  // namespace cloth
