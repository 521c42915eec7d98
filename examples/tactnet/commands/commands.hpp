#pragma once

// The subcommands, and what all of them include. Each adds its options to the program and returns what to do
// when it was chosen, which gives the exit status.

#include "console.hpp"
#include "number_options.hpp"
#include "reports/report.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/text/message.hpp>

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <system_error>

using command = std::function<int()>;

command add_check(CLI::App& program);
command add_train(CLI::App& program);
command add_evaluate(CLI::App& program);
command add_classify(CLI::App& program);
command add_export(CLI::App& program);
command add_list(CLI::App& program);
command add_recommend(CLI::App& program);
command add_study(CLI::App& program);
command add_simulate(CLI::App& program);
command add_sensor(CLI::App& program);
