#include <tactnet/io/model_description.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/save_model.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

safetensors file_of(const file_metadata& metadata) {
    safetensors_writer writer;
    writer.metadata = metadata;
    return safetensors::parse(writer.to_bytes(), "m.safetensors");
}

file_metadata example() {
    file_metadata metadata{{"network", "small"}, {"seed", "7"}};
    add_description(metadata, {.network = "not written",
                               .rows = 4,
                               .columns = 6,
                               .classes = {"cable", "a \"quoted\", one", "Schlüssel"},
                               .epsilon = 0.1,
                               .subtracts_mean = true,
                               .scale = 1.0F / 255});
    return metadata;
}

/// A description of one class, without what may be missing.
model_description least() {
    return {.network = {},
            .rows = 4,
            .columns = 6,
            .classes = {"cable"},
            .epsilon = {},
            .subtracts_mean = false,
            .scale = {}};
}

} // namespace

TEST_CASE("model_description: what was added is read back, number for number") {
    const model_description d = describe_model(file_of(example()));
    CHECK(d.network == "small");
    CHECK(d.rows == 4);
    CHECK(d.columns == 6);
    CHECK(d.classes == std::vector<std::string>{"cable", "a \"quoted\", one", "Schlüssel"});
    CHECK(d.epsilon == 0.1);
    CHECK(d.subtracts_mean == true);
    CHECK(d.scale == 1.0F / 255);
    CHECK_FALSE(d.bits);
    CHECK_FALSE(d.temperature);
}

TEST_CASE("model_description: the temperature of calibrated probabilities, where there is one") {
    file_metadata metadata;
    model_description calibrated = least();
    calibrated.temperature = 2.0 / 3;
    add_description(metadata, calibrated);
    CHECK(describe_model(file_of(metadata)).temperature == 2.0 / 3);
    for (const char* wrong :
         {"1e-320", "0.0009", "1001", "1e300"}) { // which give probabilities of 0, 1 or NaN
        metadata["temperature"] = wrong;
        CHECK_THROWS_WITH_AS(
            static_cast<void>(describe_model(file_of(metadata))),
            doctest::Contains("metadata 'temperature': expected a number from 0.001 to 1000"), file_error);
    }
    metadata["format"] = "pt"; // another program's word
    CHECK_FALSE(describe_model(file_of(metadata)).temperature);
}

TEST_CASE("model_description: of 8 bits it needs no epsilon and no scale") {
    file_metadata metadata;
    model_description bytes = least();
    bytes.bits = 8;
    add_description(metadata, bytes);
    CHECK(metadata.at("bits") == "8");
    CHECK(metadata.size() == 7);
    const model_description d = describe_model(file_of(metadata));
    CHECK(d.bits == 8U);
    CHECK_FALSE(d.epsilon);
    CHECK_FALSE(d.scale);
    for (const char* wrong : {"4", "32", "0", "", "8 ", "eight"}) {
        metadata["bits"] = wrong;
        CHECK_THROWS_WITH_AS(static_cast<void>(describe_model(file_of(metadata))),
                             doctest::Contains("metadata 'bits': expected '8', or none for single precision"),
                             file_error);
    }
    CHECK_FALSE(describe_model(file_of({{"bits", "4"}})).bits); // another program's word
}

TEST_CASE("model_description: a name is short, of other programs too") {
    CHECK(describe_model(file_of({{"network", std::string(200, 'n')}})).network.size() == 200);
    CHECK_THROWS_WITH_AS(static_cast<void>(describe_model(file_of({{"network", std::string(201, 'n')}}))),
                         doctest::Contains("metadata 'network': expected a name of at most 200 bytes"),
                         file_error);
    file_metadata metadata{{"network", std::string(201, 'n')}};
    CHECK_THROWS_WITH_AS(add_description(metadata, least()),
                         "network: expected a name of at most 200 bytes, found 201", std::invalid_argument);
    metadata["network"].pop_back();
    CHECK_NOTHROW(add_description(metadata, least()));
}

TEST_CASE("model_description: a file without metadata") {
    const model_description d = describe_model(file_of({}));
    CHECK(d.network.empty());
    CHECK_FALSE(d.rows);
    CHECK_FALSE(d.columns);
    CHECK(d.classes.empty());
    CHECK_FALSE(d.epsilon);
    CHECK_FALSE(d.subtracts_mean);
    CHECK_FALSE(d.scale);
}

TEST_CASE("model_description: numbers: our own must mean something, those of others may mean anything") {
    for (const char* key : {"rows", "columns", "epsilon", "input_scale", "temperature"})
        for (const char* wrong : {"", "0", "-1", "nan", "inf", "4 ", "four"}) {
            file_metadata metadata = example();
            metadata[key] = wrong;
            CAPTURE(key);
            CAPTURE(wrong);
            CHECK_THROWS_AS(static_cast<void>(describe_model(file_of(metadata))), file_error);
            metadata["format"] = "pt";
            CHECK_NOTHROW(static_cast<void>(describe_model(file_of(metadata))));
        }
}
