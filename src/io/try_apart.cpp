#include "io/try_apart.h"

#include <fmt/format.h>

#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

namespace meniscus::io {
namespace {

[[noreturn]] void work_in_copy(const std::function<void()>& work, int seconds) {
  for (const int number : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU}) std::signal(number, SIG_DFL);
  const rlimit no_core{0, 0}, time{static_cast<rlim_t>(seconds), static_cast<rlim_t>(seconds)};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &time);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  try {
    work();
  } catch (...) {  // whoever does the work again meets it, too
  }
  _exit(0);  // nothing of this process is written or torn down by its copy
}

}  // namespace

std::optional<std::string> what_stops(const std::function<void()>& work, int seconds) {
  const pid_t copy = fork();
  if (copy < 0) return std::nullopt;
  if (copy == 0) work_in_copy(work, seconds);
  int status = 0;
  while (waitpid(copy, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;  // somebody else has waited for it
  if (WIFSIGNALED(status)) {
    const int number = WTERMSIG(status);
    if (number == SIGXCPU || number == SIGKILL) return fmt::format("it took more than {} s", seconds);
    return fmt::format("signal {} ({})", number, strsignal(number));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0) return fmt::format("exit code {}", WEXITSTATUS(status));
  return std::nullopt;
}

}  // namespace meniscus::io

#else

namespace meniscus::io {

std::optional<std::string> what_stops(const std::function<void()>&, int) { return std::nullopt; }

}  // namespace meniscus::io

#endif
