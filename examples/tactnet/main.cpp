// tactnet: trains networks and support vector machines on a folder of tactile images, evaluates them,
// recognises images, writes networks as C++ headers, simulates and checks images, looks at sensors, and
// studies what accuracy costs in time.
//
// Exit status: 0, 1 (a training diverged, images that are not right), 2 (bad input or arguments, output that
// cannot be written), 130 (interrupted).

#include "commands/commands.hpp"
#include "methods/description.hpp"

#include <exception>
#include <new>
#include <program_arguments.hpp>
#include <sstream>
#include <stack.hpp>

namespace {

int run(std::span<const char* const> words) {
    CLI::App program(
        "Recognises touched objects from the pressure images of tactile arrays (instruction set: " +
            describe_program().at("instruction_set") + ")",
        "tactnet");
    program.require_subcommand(1);
    program.option_defaults()->always_capture_default();
    std::vector<std::pair<CLI::App*, command>> commands;
    for (const auto add : {add_train, add_evaluate, add_classify, add_export, add_list, add_simulate,
                           add_study, add_recommend, add_check, add_sensor}) {
        command action = add(program);
        commands.emplace_back(program.get_subcommands({}).back(), std::move(action));
    }
    program.failure_message([](const CLI::App* app, const CLI::Error& error) {
        std::string text = error.what();
        if (const auto rest = app->remaining(); error.get_name() == "RequiredError" && !rest.empty())
            text += ", found '" + rest.front() + "'"; // no such subcommand
        return printable(text) + "\nRun with --help for more information.\n";
    });
    try {
        program.parse(std::vector<std::string>(words.rbegin(), words.rend())); // which begins at the back
    } catch (const CLI::ParseError& error) {
        std::ostringstream out, problem;
        const int status = program.exit(error, out, problem); // help, or what is wrong
        print(out.str());
        show(problem.str());
        return status == 0 ? success : bad_input;
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
    const program_arguments words(count, arguments);
    const auto complain = [](const std::exception& error, int status) {
        tell("tactnet: {}\n", printable(error.what()));
        return status;
    };
    try {
        const int status = run(words.words());
        finish_output();
        return status;
    } catch (const tactnet::file_error& error) {
        return complain(error, bad_input);
    } catch (const usage_error& error) {
        return complain(error, bad_input);
    } catch (const std::bad_alloc&) {
        tell("tactnet: expected enough memory, found none left\n");
        return failed;
    } catch (const std::system_error& error) { // a thread too many
        tell("tactnet: the system refuses what it was asked for: '{}'\n", printable(error.what()));
        return failed;
    } catch (const std::exception& error) { // a training that diverged
        return complain(error, failed);
    }
}
