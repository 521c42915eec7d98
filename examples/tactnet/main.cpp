// tactnet: trains networks and support vector machines on a folder of tactile images, evaluates them,
// recognises images, writes networks as C++ headers, simulates and checks images, and studies what accuracy
// costs in time.
//
// Exit status: 0, 1 (a training diverged, images that are not right), 2 (bad input or arguments, output that
// cannot be written), 130 (interrupted).

#include "commands/commands.hpp"
#include "console/standard_streams.hpp"
#include "methods/description.hpp"
#include "usage_error.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/text/quoting.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <new>
#include <printable.hpp>
#include <sstream>
#include <stack.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace {

using command_list = std::vector<std::pair<CLI::App*, command>>;

/// The slips that lead from one word to the other: a letter too many, too few, another one, two exchanged
/// (optimal string alignment).
std::size_t slips(std::string_view a, std::string_view b) {
    const std::size_t width = b.size() + 1;
    std::vector<std::size_t> table((a.size() + 1) * width);
    const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return table[i * width + j]; };
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                at(i, j) = i + j;
                continue;
            }
            at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1,
                                 at(i - 1, j - 1) + static_cast<std::size_t>(a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
        }
    return table.back();
}

/// The name that was most likely meant: it differs by two slips at most, and by less than half of it. Empty
/// if there is none.
std::string closest_name(std::string_view typed, const std::vector<std::string>& names) {
    std::string closest;
    std::size_t fewest = 3;
    for (const std::string& name : names)
        if (typed.size() <= name.size() + 2) // a longer one is no slip, and a large table
            if (const std::size_t n = slips(typed, name); n < fewest && 2 * n < name.size())
                fewest = n, closest = name;
    return closest;
}

/// A sentence on what was meant, if a command or an option is nearly one that there is.
std::string suggestion(const command_list& commands, const std::vector<std::string>& arguments) {
    const auto sentence = [](const std::string& typed, const std::vector<std::string>& names) {
        const std::string meant = closest_name(typed, names);
        return meant.empty() ? ""
                             : "There is no " + tactnet::in_quotes(typed) + "; did you mean " +
                                   tactnet::in_quotes(meant) + "?\n";
    };
    std::vector<std::string> names;
    for (const auto& [subcommand, run] : commands) {
        names.push_back(subcommand->get_name());
        if (!subcommand->parsed())
            continue;
        std::vector<std::string> options;
        for (const CLI::Option* option : subcommand->get_options())
            for (const std::string& name : option->get_lnames())
                options.push_back("--" + name);
        for (const std::string& typed : subcommand->remaining())
            if (std::string text = sentence(typed.substr(0, typed.find('=')), options);
                typed.starts_with("--") && !text.empty())
                return text;
        return {};
    }
    return arguments.empty() || arguments.front().starts_with('-') ? "" : sentence(arguments.front(), names);
}

/// Help, or what is wrong with the arguments.
int explain(const CLI::App& program, const CLI::ParseError& error, const command_list& commands,
            const std::vector<std::string>& arguments) {
    std::ostringstream out, problem;
    const int status = program.exit(error, out, problem);
    print(out.str());
    show(problem.str());
    if (status != 0)
        show(suggestion(commands, arguments));
    return status == 0 ? success : bad_input;
}

int run(int count, char** arguments) {
    CLI::App program(
        "Recognises touched objects from the pressure images of tactile arrays (instruction set: " +
            std::string(program_instruction_set()) + ")",
        "tactnet");
    program.require_subcommand(1);
    program.option_defaults()->always_capture_default();
    command_list commands;
    for (const auto add : {add_train, add_evaluate, add_classify, add_export, add_list, add_simulate,
                           add_study, add_recommend, add_check}) {
        command action = add(program);
        commands.emplace_back(program.get_subcommands({}).back(), std::move(action));
    }
    program.failure_message([](const CLI::App*, const CLI::Error& error) {
        return printable(error.what()) + "\nRun with --help for more information.\n";
    });
    try {
        program.parse(count, arguments);
    } catch (const CLI::ParseError& error) {
        return explain(program, error, commands,
                       std::vector<std::string>(arguments + (count > 0), arguments + count));
    }
    for (const auto& [subcommand, run_command] : commands)
        if (subcommand->parsed())
            return run_command();
    return success;
}

} // namespace

int main(int count, char** arguments) {
    prepare_standard_streams();
    require_stack("tactnet");
    const auto complain = [](const std::exception& error, int status) {
        tell("tactnet: {}\n", printable(error.what()));
        return status;
    };
    try {
        const int status = run(count, arguments);
        finish_output();
        return status;
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
}
