#pragma once

// The subcommands. Each adds its options to the program and returns what to do when it was chosen, which
// gives the exit status.

#include <functional>

namespace CLI {
class App;
}

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
