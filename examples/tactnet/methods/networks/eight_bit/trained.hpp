#pragma once

// Networks in 8 bits, as what trainings and files leave.

#include "methods/method.hpp"
#include "methods/networks/eight_bit/compiled.hpp"

#include <cstddef>
#include <memory>
#include <span>

/// A model in 8 bits; `images` are those of its training, of which `chosen` tell what numbers its maps hold.
/// Throws std::invalid_argument for a model that has no such form.
std::unique_ptr<trained_network>
make_eight_bit_network(const compiled_network& code, const compiled_eight_bit& bytes, const any_model& model,
                       const tactnet::labelled_images& images, std::span<const std::size_t> chosen);
/// From a file in 8 bits. Throws tactnet::file_error.
std::unique_ptr<trained_network> load_eight_bit_network(const compiled_network& code,
                                                        const compiled_eight_bit& bytes,
                                                        const tactnet::safetensors& file);

/// Bytes of its arrays in a file for so many classes, without the mean image.
std::size_t eight_bit_parameter_bytes(const compiled_eight_bit& bytes, std::size_t classes);
