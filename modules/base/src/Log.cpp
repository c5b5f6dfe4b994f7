// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/base/Log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <string>

namespace vernier {
namespace {
spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> instance = [] {
    auto l = std::make_shared<spdlog::logger>("vernier", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    const char* wanted = std::getenv("VERNIER_LOG");
    const std::string level = wanted ? wanted : "warning";
    l->set_level(level == "debug"  ? spdlog::level::debug
                 : level == "info" ? spdlog::level::info
                                   : spdlog::level::warn);
    l->set_pattern("vernier %l: %v");
    return l;
  }();
  return *instance;
}
}  // namespace

void log(LogLevel level, std::string_view room, std::string_view message) {
  const auto l = level == LogLevel::Debug     ? spdlog::level::debug
                 : level == LogLevel::Info    ? spdlog::level::info
                 : level == LogLevel::Warning ? spdlog::level::warn
                                              : spdlog::level::err;
  logger().log(l, "{}: {}", room, message);
}

}  // namespace vernier
