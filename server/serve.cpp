#include "server/serve.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <future>
#include <iostream>
#include <stdexcept>
#include <thread>

#include "server/calibration_file.hpp"
#include "server/files.hpp"
#include "server/http_server.hpp"
#include "server/inherited_socket.hpp"
#include "server/store.hpp"

namespace quicksand {
namespace {

/// Within these the workers and then the connections must end; together less than the 10 s that a service
/// manager is told to wait.
constexpr std::chrono::milliseconds worker_patience{6000}, connection_patience{3000};

/// Without keys anybody who reaches the port could run and read everything.
void require_keys_or_loopback(KeyStore& keys, const std::string& host) {
  if (!is_loopback(host) && !keys.any())
    throw std::runtime_error(
        "host = " + host +
        " refused: without API keys the server listens on this machine only (127.0.0.1); "
        "make one with quicksand keys create");
}

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

/// Ends the process without waiting for what does not end by itself; the store is in order at any time.
[[noreturn]] void leave_now(StateFolder& folder) {
  folder.withdraw();
  spdlog::default_logger()->flush();
  ::_exit(0);
}

/// The URL of a socket that now listens: the service manager's, or one bound here.
std::string listen(HttpServer& http, const Settings& settings,
                   const std::optional<InheritedSocket>& inherited) {
  if (inherited) http.adopt(inherited->descriptor);
  const int port = inherited ? inherited->port : http.bind(settings.host, static_cast<int>(settings.port));
  if (port == 0) return "http+unix://";
  const bool six = settings.host.find(':') != std::string::npos;
  return "http://" + (six ? "[" + settings.host + "]" : settings.host) + ":" + std::to_string(port);
}

}  // namespace

void serve(Settings settings) {
  const auto inherited = inherited_socket();
  if (inherited) settings.host = inherited->host;
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // inherited by every thread; one of them waits for them

  make_private();
  StateFolder folder(settings.state);
  Store store(folder.database());
  KeyStore keys(folder.database());
  require_keys_or_loopback(keys, settings.host);
  ChangeBell bell;
  Metrics metrics;
  Runner runner(store, folder, bell, metrics, settings);
  Service service{store,
                  keys,
                  runner,
                  bell,
                  folder,
                  metrics,
                  settings,
                  read_catalogue(settings.cases),
                  read_calibration(state_calibration(folder.path()))};
  HttpServer http(service);
  const std::string url = listen(http, settings, inherited);
  runner.start();
  folder.announce(url);
  std::cout << "quicksand serves " << url << " state " << folder.path().string() << std::endl;

  std::promise<void> connections_ended;
  std::thread stopper([&, ended = connections_ended.get_future()] {
    int signal = 0;
    sigwait(&signals, &signal);
    spdlog::info("signal {}, stopping", signal);
    service.stopping = true;
    bell.close();
    runner.begin_stop();
    http.stop();
    if (!runner.wait_stopped(worker_patience)) leave_now(folder);
    if (ended.wait_for(connection_patience) != std::future_status::ready) leave_now(folder);
  });
  http.serve();
  connections_ended.set_value();
  if (!service.stopping) ::kill(::getpid(), SIGTERM);  // the listening socket died by itself
  stopper.join();
}

}  // namespace quicksand
