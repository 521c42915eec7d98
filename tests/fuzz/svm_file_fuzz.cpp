// Any bytes as the file of a support vector machine: it is loaded, or refused with a file_error, and nothing
// else happens. What was loaded gives values for any row, bit-exact once saved and loaded again.

#include "fuzz_target.hpp"
#include "safetensors_input.hpp"

#include <tactnet/io/svm_file.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

using fuzz::require;
using linear = tactnet::linear_machine<>;
template <class Kernel>
using kernel = tactnet::kernel_machine<Kernel>;

template <class Machine>
Machine load(const tactnet::safetensors& file) {
    if constexpr (std::is_same_v<Machine, linear>)
        return tactnet::load_linear_machine(file);
    else if constexpr (std::is_same_v<Machine, kernel<tactnet::rbf_kernel>>)
        return tactnet::load_kernel_machine<tactnet::rbf_kernel>(file);
    else
        return tactnet::load_kernel_machine<tactnet::linear_kernel>(file);
}

/// All that a machine says of some rows. Numbers may have overflowed, so bits are compared.
template <class Machine>
std::vector<double> answers(const Machine& machine) {
    std::vector<float> values(2 * machine.features(), 0.5F);
    values.front() = -3;
    const tactnet::feature_rows<> rows(values, machine.features());
    std::vector<double> all;
    std::vector<std::size_t> labels;
    if constexpr (std::is_same_v<Machine, linear>) {
        all = machine.decision_values(rows);
        labels = machine.predict(rows);
        require(all.size() == 2 * machine.classes());
    } else {
        tactnet::thread_pool alone;
        all = machine.decision_values(rows, alone);
        labels = machine.predict(rows, alone);
        require(all.size() == 2 * machine.machines());
        if (!machine.parameters().sigmoids.empty()) {
            const std::vector<double> probabilities = machine.probabilities(rows, alone);
            require(probabilities.size() == 2 * machine.classes());
            all.insert(all.end(), probabilities.begin(), probabilities.end());
        }
    }
    require(labels.size() == 2);
    all.insert(all.end(), labels.begin(), labels.end());
    return all;
}

template <class Machine>
void check_as(const tactnet::safetensors& file) {
    try {
        const Machine machine = load<Machine>(file);
        tactnet::safetensors_writer writer;
        tactnet::add_machine(writer, machine);
        const auto again = load<Machine>(tactnet::safetensors::parse(writer.to_bytes(), "again"));
        const std::vector<double> before = answers(machine), after = answers(again);
        require(before.size() == after.size());
        require(std::memcmp(before.data(), after.data(), before.size() * sizeof(double)) == 0);
    } catch (const tactnet::file_error& error) {
        require(error.file() == "input" && !error.expected().empty() && !error.found().empty());
    }
}

void check(std::vector<std::byte> bytes) {
    try {
        // Or hardly any mutated file would come further.
        const auto file =
            tactnet::safetensors::parse(std::move(bytes), "input", tactnet::checksum_rule::ignore);
        check_as<linear>(file);
        check_as<kernel<tactnet::linear_kernel>>(file);
        check_as<kernel<tactnet::rbf_kernel>>(file);
    } catch (const tactnet::file_error&) {
        // No safetensors file.
    }
}

/// Three classes of two features, with one, two and one support vectors.
template <class Kernel>
tactnet::kernel_machine_parameters<Kernel> some_parameters(tactnet::multiclass scheme) {
    tactnet::kernel_machine_parameters<Kernel> parts;
    parts.scheme = scheme;
    parts.features = 2;
    parts.labels = {0, 3, 4};
    parts.support_counts = {1, 2, 1};
    parts.support_vectors = {1, 2, 3, 4, -1, 0.5F, 0, 7};
    for (std::size_t i = 0; i < 4 * parts.coefficients_each(); ++i)
        parts.coefficients.push_back(i % 2 == 0 ? 0.5 : -0.25);
    parts.offsets = {0.5, -1, 0};
    return parts;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    check_both_forms(data, size, check);
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    std::vector<std::vector<std::uint8_t>> seeds;
    const auto add = [&](const auto& machine) {
        tactnet::safetensors_writer writer;
        tactnet::add_machine(writer, machine);
        add_seeds(seeds, writer);
    };
    const tactnet::standardisation standardise{{0.5F, -1}, {2, 0.25F}};

    auto rbf = some_parameters<tactnet::rbf_kernel>(tactnet::multiclass::one_versus_one);
    rbf.kernel.gamma = 0.5;
    rbf.sigmoids = {{-1, 0.5}, {-2, 0}, {0, 1}};
    rbf.standardise = standardise;
    add(kernel<tactnet::rbf_kernel>(rbf));

    auto products = some_parameters<tactnet::linear_kernel>(tactnet::multiclass::one_versus_rest);
    products.sigmoids = rbf.sigmoids;
    add(kernel<tactnet::linear_kernel>(products));

    tactnet::linear_machine_parameters rows;
    rows.features = 2;
    rows.labels = {1, 2};
    rows.weights = {1, -2, 0.5F, 3};
    rows.offsets = {0.25, -1};
    add(linear(rows));
    rows.standardise = standardise;
    add(linear(rows));
    return seeds;
}
