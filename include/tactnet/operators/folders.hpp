// The folders of operators/: a new operator is one line here. The umbrellas of this room each name a file of
// a folder and include this list: operators.hpp its layer.hpp, operators/training.hpp its training.hpp, and
// so on. Included by itself, the list includes the layers. It has no guard, since each umbrella reads it.

// clang-format off
#ifndef TACTNET_FILE_OF
#define TACTNET_FILE_OF(folder) <tactnet/operators/folder/layer.hpp>
#endif
// The file of a folder without steps in 8 bits of its own: it has none, or those of other folders.
#ifndef TACTNET_FILE_WITHOUT_STEP
#define TACTNET_FILE_WITHOUT_STEP(folder) TACTNET_FILE_OF(folder)
#endif
// clang-format on

#include TACTNET_FILE_OF(activations)
#include TACTNET_FILE_OF(batch_norm)
#include TACTNET_FILE_WITHOUT_STEP(concatenation)
#include TACTNET_FILE_OF(convolution)
#include TACTNET_FILE_OF(dense)
#include TACTNET_FILE_OF(dilated_convolution)
#include TACTNET_FILE_OF(pooling)
#include TACTNET_FILE_OF(residual)
#include TACTNET_FILE_OF(rms_norm)
#include TACTNET_FILE_OF(sample_norms)
#include TACTNET_FILE_OF(sequence)
#include TACTNET_FILE_OF(temporal)

#undef TACTNET_FILE_OF
#undef TACTNET_FILE_WITHOUT_STEP
