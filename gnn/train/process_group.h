#pragma once

#include <torch/torch.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace cloth {

/// Processes that train together have lost each other, or never met.
class ProcessGroupError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Processes that train one network together, on one machine or several, by LibTorch's c10d with
/// Gloo. They are started as PyTorch's are: each is told its number and where the first one
/// listens. All of them must make the same calls in the same order; a call returns when all have
/// made it, and throws ProcessGroupError if another process has ended.
class ProcessGroup {
 public:
    /// One process alone: it exchanges nothing.
    ProcessGroup();

    /// Joins `size` processes (1 to 1024) as number `rank` (0 to size - 1). The first one listens
    /// on `address`:`port`; all must join within `timeout` (s, 1 to 1e6).
    /// @throws ArgumentError for values out of range, ProcessGroupError if they do not meet
    ProcessGroup(int rank, int size, const std::string& address, int port, double timeout = 300.0);

    /// As RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT of the environment say; alone if WORLD_SIZE
    /// is not set.
    /// @throws ArgumentError if one of them is missing or is no number in its range
    static ProcessGroup from_environment();

    /// A port of this machine that nobody listens on at the moment.
    static int free_port();

    int rank() const { return m_rank; }
    int size() const { return m_size; }
    bool is_first() const { return m_rank == 0; }

    /// Replaces a tensor by the sum over all processes, which all get with the same bits.
    void sum(torch::Tensor& tensor) const;

    /// The bytes that the first process gives.
    std::string from_first(std::string bytes) const;

    /// The bytes of all processes, in their order; all get them.
    std::vector<std::string> from_all(const std::string& bytes) const;

 private:
    struct Backend;
    torch::Tensor broadcast(torch::Tensor tensor, int from) const;

    int m_rank = 0, m_size = 1;
    std::shared_ptr<Backend> m_backend;  ///< null: alone
};

}  // namespace cloth
