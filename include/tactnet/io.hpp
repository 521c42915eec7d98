#pragma once

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/file.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/image_folder.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/parameters.hpp>
#include <tactnet/io/partial_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/element_type.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/text.hpp>
