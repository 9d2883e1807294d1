#pragma once

// One API in two libraries: libsumo, and with LIBTRACI defined libtraci. Their headers exclude each
// other; their functions are the same, in two namespaces. What is written against them is compiled
// twice, in a namespace of its own each time.
#ifdef LIBTRACI
#include <libsumo/libtraci.h>
#define MVTP_SUMO_NAMESPACE over_libtraci
namespace mvtp::over_libtraci {
namespace api = libtraci;
}
#else
#include <libsumo/libsumo.h>
#define MVTP_SUMO_NAMESPACE over_libsumo
namespace mvtp::over_libsumo {
namespace api = libsumo;
}
#endif
