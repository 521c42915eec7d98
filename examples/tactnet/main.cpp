// tactnet: trains networks and support vector machines on a folder of tactile images, evaluates them,
// recognises images, writes networks as C++ headers, and simulates images.
//
// Exit status: 0, 1 (a training diverged), 2 (bad input or arguments), 130 (interrupted).

#include "commands/commands.hpp"
#include "reports/printable.hpp"
#include "usage_error.hpp"

#include <tactnet/io/file_error.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

int main(int count, char** arguments) {
    CLI::App program("Recognises touched objects from the pressure images of tactile arrays", "tactnet");
    program.require_subcommand(1);
    std::vector<std::pair<CLI::App*, command>> commands;
    for (const auto add : {add_train, add_evaluate, add_classify, add_export, add_list, add_simulate}) {
        command run = add(program);
        commands.emplace_back(program.get_subcommands({}).back(), std::move(run));
    }
    program.failure_message([](const CLI::App*, const CLI::Error& error) {
        return printable(error.what()) + "\nRun with --help for more information.\n";
    });
    try {
        program.parse(count, arguments);
    } catch (const CLI::ParseError& error) {
        return program.exit(error) == 0 ? success : bad_input;
    }

    const auto complain = [](const std::exception& error, int status) {
        fmt::print(stderr, "tactnet: {}\n", printable(error.what()));
        return status;
    };
    try {
        for (const auto& [subcommand, run] : commands)
            if (subcommand->parsed())
                return run();
    } catch (const tactnet::file_error& error) {
        return complain(error, bad_input);
    } catch (const usage_error& error) {
        return complain(error, bad_input);
    } catch (const std::bad_alloc&) {
        return complain(std::runtime_error("expected enough memory, found none left"), failed);
    } catch (const std::system_error& error) { // a thread too many
        return complain(
            std::runtime_error(fmt::format("the system refuses what it was asked for: '{}'", error.what())),
            failed);
    } catch (const std::exception& error) { // a training that diverged
        return complain(error, failed);
    }
    return success;
}
