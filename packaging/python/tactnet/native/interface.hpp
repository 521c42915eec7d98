#pragma once

// What the Python module knows of a network: all that depends on its type, as functions. The module is
// compiled once; for each network, the machine's compiler makes a shared library for what is asked of it:
// described.hpp, deployed.hpp, trainable.hpp, eight_bit.hpp and stream.hpp. So it is with an array of
// tactels, sensor.hpp and scene.hpp, and with objects, object.hpp.

#include <tactnet/deployment/export/header_description.hpp>
#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/detail/instruction_set.hpp>
#include <tactnet/lowering/input_function.hpp>
#include <tactnet/networks/reflection_rule.hpp>
#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {
class thread_pool;
class trainable;
struct folded_layout;
}} // namespace tactnet

namespace tactnet_python {

/// The constants of a network's type.
struct network_facts {
    tactnet::shape input, output;
    std::vector<tactnet::parameter> arrays;
    std::size_t parameters, statistics, multiply_adds, multiply_adds_on_pixels, activation_bytes;
    bool needs_counts, ends_in_softmax;
};

/// The numbers of a trained network. Arrays may be shorter than the network's: the other elements are zero.
struct trained_numbers {
    std::vector<std::vector<float>> arrays;
    double epsilon = 1e-5;
    std::vector<float> mean; ///< of the input, as many as elements
    float scale = 1;
    tactnet::input_function function{};
};

/// Frames one after the other, of bytes or of floats.
struct frames_view {
    const void* elements;
    bool are_counts;
    std::size_t count;
};

/// A deployed network of any type.
class any_deployed {
public:
    virtual ~any_deployed() = default;
    /// Writes a row of outputs for each frame.
    virtual tactnet::frame_status infer(const frames_view& frames, std::span<float> outputs,
                                        std::size_t threads) const = 0;
    /// The text of a C++ header. `frame` is for its self-test.
    virtual std::string header(const tactnet::header_description& description, double temperature,
                               const tactnet::reflection_rule& reflections,
                               std::span<const std::uint8_t> frame) const = 0;
    virtual std::span<const float> folded() const = 0;
    /// Writes a row of `features` for each frame: what the last layer reads.
    virtual tactnet::frame_status read_features(const frames_view& frames, std::span<float> to) const = 0;
    std::size_t weight_bytes = 0, workspace_bytes = 0, features = 0; ///< 0 features if it has none
};

/// A deployed network of sequences, with the state of one recording.
class any_stream {
public:
    virtual ~any_stream() = default;
    /// Takes frames, writes a row of outputs for each, and returns how many it took: those before a broken
    /// one.
    virtual std::size_t run(std::span<const float> frames, std::span<float> outputs) = 0;
    virtual void reset() = 0;
    virtual std::vector<std::byte> state() const = 0;
    /// Whether these are bytes of a state of this stream. If not, the state stays.
    virtual bool restore(std::span<const std::byte> state) = 0;
    virtual std::string header(const tactnet::header_description& description,
                               std::span<const float> recording) const = 0;
    std::size_t features = 0, outputs = 0;
};

struct sensor_settings;
class any_sensor;
class any_scene;
class any_discriminant;
class any_means;

/// What has been compiled for a network's type, or for an array; each shared library has some of it.
struct network_code {
    std::string_view instruction_set = tactnet::instruction_set;
    network_facts (*facts)() = nullptr;
    std::unique_ptr<tactnet::trainable> (*trainable)() = nullptr;
    std::unique_ptr<any_deployed> (*deploy)(const trained_numbers&) = nullptr;
    /// In 8 bits: the layout of the folded numbers, how they are found from images, and a network of them.
    tactnet::folded_layout (*layout)() = nullptr;
    std::vector<float> (*calibrate)(const trained_numbers&, const frames_view& images) = nullptr;
    std::unique_ptr<any_deployed> (*deploy_folded)(std::span<const float> folded,
                                                   const tactnet::input_function&) = nullptr;
    /// Of a network of sequences; with training sequences, in 8 bits.
    std::unique_ptr<any_stream> (*stream)(const trained_numbers&) = nullptr;
    std::unique_ptr<any_stream> (*stream_in_8_bits)(const trained_numbers&,
                                                    std::span<const float> sequences) = nullptr;
    std::unique_ptr<any_sensor> (*sensor)(const sensor_settings&) = nullptr;
    /// With metres from tactel to tactel, and the sensor's number.
    std::unique_ptr<any_scene> (*scene)(double pitch, std::uint64_t unit) = nullptr;
    std::unique_ptr<any_discriminant> (*discriminant)() = nullptr;
    std::unique_ptr<any_means> (*means)() = nullptr;
};

} // namespace tactnet_python
