#include "trimquad/brep/checker.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <mutex>

#include "trimquad/base/error.h"

extern char** environ;

namespace trimquad {
namespace {

/// A check and its answer travel as sizes and bytes.
struct Request {
  std::uint64_t size;  ///< of the shape that follows
  std::int32_t seconds;
  std::uint8_t elements, crossings, selfCrossings;
};

constexpr int kCancelledWithin = 100;  // milliseconds

bool sendAll(int socket, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = send(socket, at, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    size -= std::size_t(sent);
  }
  return true;
}

bool receiveAll(int socket, void* data, std::size_t size, const Progress* progress = nullptr) {
  char* at = static_cast<char*>(data);
  while (size > 0) {
    if (progress != nullptr) {
      pollfd waited{socket, POLLIN, 0};
      const int ready = poll(&waited, 1, kCancelledWithin);
      progress->check();
      if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    }
    const ssize_t got = recv(socket, at, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= std::size_t(got);
  }
  return true;
}

bool sendTexts(int socket, const std::vector<std::string>& texts) {
  const std::uint64_t count = texts.size();
  if (!sendAll(socket, &count, sizeof count)) return false;
  for (const auto& text : texts) {
    const std::uint64_t size = text.size();
    if (!sendAll(socket, &size, sizeof size) || !sendAll(socket, text.data(), size)) return false;
  }
  return true;
}

std::optional<std::vector<std::string>> receiveTexts(int socket, const Progress& progress) {
  std::uint64_t count = 0;
  if (!receiveAll(socket, &count, sizeof count, &progress)) return {};
  std::vector<std::string> texts(count);
  for (auto& text : texts) {
    std::uint64_t size = 0;
    if (!receiveAll(socket, &size, sizeof size, &progress)) return {};
    text.resize(size);
    if (!receiveAll(socket, text.data(), size, &progress)) return {};
  }
  return texts;
}

}  // namespace

/// One running program, ended with this value.
class Checker::Process {
 public:
  explicit Process(const std::string& program) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw unusable(program);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    // OpenCASCADE prints to the standard output.
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t usual, none;
    sigemptyset(&none);
    sigemptyset(&usual);
    for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGPROF}) sigaddset(&usual, number);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setsigmask(&attributes, &none);
    // A group of its own: an interrupt from the terminal is for this process, which ends the other one.
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    std::string name = program;
    char* arguments[] = {name.data(), nullptr};
    const int failed = posix_spawn(&id_, program.c_str(), &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    socket_ = ends[0];
    if (failed != 0) {
      close(socket_);
      errno = failed;
      throw unusable(program);
    }
  }
  ~Process() {
    close(socket_);
    kill(id_, SIGKILL);
    while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  std::optional<std::vector<std::string>> faults(const std::string& shape, FaultKinds kinds, int seconds,
                                                 const Progress& progress) const {
    const Request request{shape.size(), seconds, kinds.elements, kinds.crossings, kinds.selfCrossings};
    if (!sendAll(socket_, &request, sizeof request) || !sendAll(socket_, shape.data(), shape.size()))
      return {};
    return receiveTexts(socket_, progress);
  }

 private:
  static Error unusable(const std::string& program) {
    return inputError("setup",
                      std::string("the program that checks shapes cannot be run (") + std::strerror(errno) +
                          "); build TrimQuad again",
                      program);
  }

  pid_t id_ = 0;
  int socket_ = -1;
};

/// Those that wait for the next check.
class Checker::Processes {
 public:
  explicit Processes(std::string program) : program_(std::move(program)) {}

  std::unique_ptr<Process> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        auto process = std::move(idle_.back());
        idle_.pop_back();
        return process;
      }
    }
    return std::make_unique<Process>(program_);
  }
  void giveBack(std::unique_ptr<Process> process) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(process));
  }

 private:
  std::string program_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Process>> idle_;
};

Checker::Checker(std::string program) : processes_(std::make_unique<Processes>(std::move(program))) {}
Checker::~Checker() = default;

std::optional<std::vector<std::string>> Checker::faults(const Shape& shape, FaultKinds kinds, int seconds,
                                                        const Progress& progress) const {
  auto process = processes_->take();
  auto found = process->faults(shapeToFreeCAD(shape), kinds, seconds, progress);
  if (found) processes_->giveBack(std::move(process));
  return found;
}

void serveChecks() {
  for (Request request{}; receiveAll(STDIN_FILENO, &request, sizeof request);) {
    std::string shape(request.size, '\0');
    if (!receiveAll(STDIN_FILENO, shape.data(), shape.size())) return;
    // The system ends the process when the time is over.
    const auto limit = [](int seconds) {
      const itimerval timer{{0, 0}, {seconds, 0}};
      setitimer(ITIMER_PROF, &timer, nullptr);
    };
    limit(request.seconds);
    std::vector<std::string> found;
    try {
      found = faults(shapeFromFreeCAD(shape),
                     {request.elements != 0, request.crossings != 0, request.selfCrossings != 0});
    } catch (const Error& error) {
      found = {error.message()};
    }
    limit(0);
    if (!sendTexts(STDIN_FILENO, found)) return;
  }
}

}  // namespace trimquad
