#pragma once

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/deployed_file.hpp>
#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/pretrained.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/networks/batch_passes.hpp> // load_model and save_model compute a batch for the self-test
