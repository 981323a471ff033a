#include "gnn/train/process_group.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <torch/csrc/distributed/c10d/ProcessGroupGloo.hpp>
#include <torch/csrc/distributed/c10d/TCPStore.hpp>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

using torch::Tensor;

namespace {

// One process validates or writes while the others wait; one that has died is noticed at once.
constexpr std::chrono::milliseconds longest_wait = std::chrono::hours(6);

/// c10d and Gloo throw exceptions of several kinds.
template <typename Call>
auto reporting(const char* what, const Call& call) {
    try {
        return call();
    } catch (const c10::Error& error) {
        throw ProcessGroupError(std::string(what) + ": " + error.what_without_backtrace());
    } catch (const std::exception& error) {
        throw ProcessGroupError(std::string(what) + ": " + error.what());
    }
}

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0')
        throw ArgumentError(std::string("environment variable ") + name, "is not set",
                            "set RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT for each process, "
                            "or unset WORLD_SIZE to train with one");
    return value;
}

int number(const char* name, int low, int high) {
    const std::string text = variable(name);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != '\0' || value != std::floor(value))
        throw ArgumentError(std::string("environment variable ") + name,
                            "is '" + text + "', not a whole number",
                            "set it to " + std::to_string(low) + " to " + std::to_string(high));
    check_range(std::string("environment variable ") + name, value, low, high);
    return static_cast<int>(value);
}

Tensor to_tensor(const std::string& bytes) {
    Tensor tensor = torch::empty({static_cast<std::int64_t>(bytes.size())}, torch::kUInt8);
    std::memcpy(tensor.data_ptr(), bytes.data(), bytes.size());
    return tensor;
}

std::string to_string(const Tensor& tensor) {
    return {static_cast<const char*>(tensor.data_ptr()), static_cast<size_t>(tensor.numel())};
}

}  // namespace

struct ProcessGroup::Backend {
    c10::intrusive_ptr<c10d::ProcessGroupGloo> gloo;
};

ProcessGroup::ProcessGroup() = default;

ProcessGroup::ProcessGroup(int rank, int size, const std::string& address, int port, double timeout)
    : m_rank(rank), m_size(size) {
    check_range("size of a process group", size, 1, 1024);
    check_range("rank in a process group", rank, 0, size - 1);
    check_range("port of a process group", port, 1, 65535);
    check_range("timeout of a process group", timeout, 1.0, 1e6);
    if (size == 1) return;
    const std::string what = "process " + std::to_string(rank) + " of " + std::to_string(size) +
                             " at " + address + ":" + std::to_string(port) +
                             " did not meet the others (are all started, and does the first one "
                             "listen there?)";
    const std::chrono::milliseconds wait(static_cast<std::int64_t>(1e3 * timeout));
    m_backend = reporting(what.c_str(), [&] {
        c10d::TCPStoreOptions options;
        options.port = static_cast<std::uint16_t>(port);
        options.isServer = rank == 0;
        options.numWorkers = static_cast<std::size_t>(size);
        options.timeout = wait;
        auto store = c10::make_intrusive<c10d::TCPStore>(address, options);
        // Gloo has one time limit for meeting and for work, so they meet here.
        std::vector<std::string> all;
        for (int k = 0; k < size; ++k) all.push_back("here " + std::to_string(k));
        store->set(all[static_cast<size_t>(rank)], std::vector<std::uint8_t>{1});
        store->wait(all, wait);
        auto gloo = c10d::ProcessGroupGloo::Options::create();
        gloo->timeout = longest_wait;
        gloo->devices.push_back(address == "127.0.0.1" || address == "localhost"
                                    ? c10d::ProcessGroupGloo::createDeviceForHostname(address)
                                    : c10d::ProcessGroupGloo::createDefaultDevice());
        auto backend = std::make_shared<Backend>();
        backend->gloo = c10::make_intrusive<c10d::ProcessGroupGloo>(store, rank, size, gloo);
        return backend;
    });
}

ProcessGroup ProcessGroup::from_environment() {
    if (std::getenv("WORLD_SIZE") == nullptr) return {};
    const int size = number("WORLD_SIZE", 1, 1024);
    const int rank = number("RANK", 0, size - 1);
    const int port = number("MASTER_PORT", 1, 65535);
    return {rank, size, variable("MASTER_ADDR"), port};
}

int ProcessGroup::free_port() {
    const int listener = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    auto* const general = reinterpret_cast<sockaddr*>(&address);
    const bool bound = listener >= 0 && bind(listener, general, length) == 0 &&
                       getsockname(listener, general, &length) == 0;
    const int error = errno;
    if (listener >= 0) close(listener);
    if (!bound)
        throw ProcessGroupError(std::string("no port of this machine is free: ") +
                                std::strerror(error));
    return ntohs(address.sin_port);
}

void ProcessGroup::sum(Tensor& tensor) const {
    if (!m_backend) return;
    torch::NoGradGuard no_grad;
    reporting("another process of the training has ended", [&] {
        std::vector<Tensor> tensors{tensor.cpu()};
        m_backend->gloo->allreduce(tensors)->wait();
        if (!tensors[0].is_alias_of(tensor)) tensor.copy_(tensors[0]);
        return 0;
    });
}

Tensor ProcessGroup::broadcast(Tensor tensor, int from) const {
    return reporting("another process of the training has ended", [&] {
        c10d::BroadcastOptions options;
        options.rootRank = from;
        std::vector<Tensor> tensors{tensor};
        m_backend->gloo->broadcast(tensors, options)->wait();
        return tensors[0];
    });
}

std::string ProcessGroup::from_first(std::string bytes) const {
    if (!m_backend) return bytes;
    const Tensor size = broadcast(torch::tensor({static_cast<std::int64_t>(bytes.size())}), 0);
    if (size.item<std::int64_t>() == 0) return {};
    Tensor content =
        is_first() ? to_tensor(bytes) : torch::empty({size.item<std::int64_t>()}, torch::kUInt8);
    return to_string(broadcast(content, 0));
}

std::vector<std::string> ProcessGroup::from_all(const std::string& bytes) const {
    if (!m_backend) return {bytes};
    Tensor sizes = torch::zeros({m_size}, torch::kInt64);
    sizes[m_rank] = static_cast<std::int64_t>(bytes.size());
    sum(sizes);
    std::vector<std::string> all;
    for (int k = 0; k < m_size; ++k) {
        const auto size = sizes[k].item<std::int64_t>();
        Tensor content = k == m_rank ? to_tensor(bytes) : torch::empty({size}, torch::kUInt8);
        all.push_back(size == 0 ? std::string() : to_string(broadcast(content, k)));
    }
    return all;
}

}  // namespace cloth
