#include "io/try_apart.h"

#if defined(__linux__)
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <mutex>

namespace meniscus::io {
namespace {

using Work = void (*)(std::string_view);

struct Call {
  Work work;
  int seconds;
  std::size_t size;  ///< bytes of the request, which follows
};

/// Whether all bytes went through.
bool send_all(int socket, const void* bytes, std::size_t size) {
  for (const char* at = static_cast<const char*>(bytes); size > 0;) {
    const ssize_t sent = send(socket, at, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int socket, void* bytes, std::size_t size) {
  for (char* at = static_cast<char*>(bytes); size > 0;) {
    const ssize_t got = recv(socket, at, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

[[noreturn]] void do_work(const Call& call, const std::string& request) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const auto seconds = static_cast<rlim_t>(call.seconds);
  const rlimit no_core{0, 0}, time{seconds, seconds};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &time);
  try {
    call.work(request);
  } catch (...) {  // whoever does the work again meets it, too
  }
  _exit(0);  // nothing of the process is written or torn down by its copies
}

/// Makes a copy for every call, and answers by how it ended, until nobody is left to call.
[[noreturn]] void serve(int socket) {
  for (const int number : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGCHLD, SIGTERM})
    std::signal(number, SIG_DFL);
  std::signal(SIGINT, SIG_IGN);  // of a terminal: the process decides
  const int nowhere = open("/dev/null", O_RDWR);
  for (int standard = 0; standard < 3 && nowhere >= 0; ++standard) dup2(nowhere, standard);
  // What the process has open would stay so.
  if (socket > 3) close_range(3, static_cast<unsigned>(socket) - 1, 0);
  close_range(static_cast<unsigned>(socket) + 1, ~0u, 0);
  Call call{};
  while (receive_all(socket, &call, sizeof(call))) {
    std::string request(call.size, '\0');
    if (!receive_all(socket, request.data(), request.size())) break;
    const pid_t copy = fork();
    if (copy == 0) do_work(call, request);
    int status = 0;
    while (copy > 0 && waitpid(copy, &status, 0) < 0 && errno == EINTR) {
    }
    if (!send_all(socket, &status, sizeof(status))) break;
  }
  _exit(0);
}

/// The process that makes the copies; begun when it is asked for the first time, or has been stopped.
class Server {
 public:
  /// How the work ended, as waitpid() tells; nothing: it was not tried.
  std::optional<int> call(Work work, std::string_view request, int seconds) {
    const std::lock_guard lock(mutex_);
    for (int attempt = 0; attempt < 2; ++attempt) {
      // A copy of this process by others may not ask over the same socket.
      if (socket_ >= 0 && owner_ != getpid()) forget();
      if (socket_ < 0 && !begin()) return std::nullopt;
      const Call call{work, seconds, request.size()};
      int status = 0;
      if (send_all(socket_, &call, sizeof(call)) && send_all(socket_, request.data(), request.size()) &&
          receive_all(socket_, &status, sizeof(status)))
        return status;
      forget();
      while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
    return std::nullopt;
  }

 private:
  bool begin() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return false;
    // Not in the places of standard streams, where those are closed.
    for (int& end : ends) {
      const int placed = fcntl(end, F_DUPFD_CLOEXEC, 3);
      close(end);
      end = placed;
    }
    process_ = ends[0] < 0 || ends[1] < 0 ? -1 : fork();
    if (process_ == 0) {
      close(ends[0]);
      serve(ends[1]);
    }
    if (ends[1] >= 0) close(ends[1]);
    socket_ = ends[0];
    owner_ = getpid();
    if (process_ < 0 && socket_ >= 0) forget();
    return process_ > 0;
  }

  void forget() {
    close(socket_);
    socket_ = -1;
  }

  std::mutex mutex_;
  int socket_ = -1;
  pid_t process_ = -1, owner_ = -1;
};

}  // namespace

std::optional<std::string> what_stops(Work work, std::string_view request, int seconds) {
  static Server* const server = new Server;  // lives as long as the process, whose end ends it
  const std::optional<int> status = server->call(work, request, seconds);
  if (!status) return std::nullopt;
  if (WIFSIGNALED(*status)) {
    const int number = WTERMSIG(*status);
    if (number == SIGXCPU || number == SIGKILL) return fmt::format("it took more than {} s", seconds);
    return fmt::format("signal {} ({})", number, strsignal(number));
  }
  if (WIFEXITED(*status) && WEXITSTATUS(*status) != 0) return fmt::format("exit code {}", WEXITSTATUS(*status));
  return std::nullopt;
}

}  // namespace meniscus::io

#else

namespace meniscus::io {

std::optional<std::string> what_stops(void (*)(std::string_view), std::string_view, int) { return std::nullopt; }

}  // namespace meniscus::io

#endif
