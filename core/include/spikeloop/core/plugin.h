/* The border between Spikeloop and a node: plain data only, so that a plug-in built by another
 * compiler, standard library or Spikeloop version is either called correctly or refused with a
 * sentence. <spikeloop/core/plugin.hpp> wraps it in C++. Built-in nodes see the same step data.
 *
 * Rule of change: whatever changes raises SPIKELOOP_ABI_VERSION, which must be the same on both
 * sides. The members that are checked before anything else is read never move. */
#ifndef SPIKELOOP_CORE_PLUGIN_H
#define SPIKELOOP_CORE_PLUGIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPIKELOOP_ABI_VERSION 2u

/* A spike: simulated time in nanoseconds and 0-based channel. */
typedef struct spikeloop_spike {
  int64_t time_ns;
  int32_t channel;
  int32_t reserved;
} spikeloop_spike;

/* A continuous input, constant over the interval. revision 0: no value yet (invalid); an unchanged
 * revision promises unchanged values. */
typedef struct spikeloop_signal_input {
  const double* values;
  uint64_t revision;
  uint32_t width;
  uint32_t reserved;
} spikeloop_signal_input;

/* A continuous output. The node writes `values` and then raises `revision` by one; setting
 * revision to 0 makes the signal invalid. Left alone, the signal stays as it was. */
typedef struct spikeloop_signal_output {
  double* values;
  uint64_t revision;
  uint32_t width;
  uint32_t reserved;
} spikeloop_signal_output;

/* Spikes of the interval, sorted by (time, channel). Those stamped at or before the interval's
 * begin came late; they stand first, and a node applies them with their true age. */
typedef struct spikeloop_spike_input {
  const spikeloop_spike* spikes;
  uint64_t count;
  uint32_t width;
  uint32_t reserved;
} spikeloop_spike_input;

/* Where a node puts its spikes, in any order, each stamped inside the interval. */
typedef struct spikeloop_spike_output {
  void* sink;
  void (*append)(void* sink, const spikeloop_spike* spikes, uint64_t count);
  uint32_t width;
  uint32_t reserved;
} spikeloop_spike_output;

/* One call of step: the interval (begin_ns, end_ns] and the ports, each kind in the order in which
 * the node's class lists them. */
typedef struct spikeloop_step {
  int64_t begin_ns;
  int64_t end_ns;
  const spikeloop_signal_input* signal_inputs;
  const spikeloop_spike_input* spike_inputs;
  spikeloop_signal_output* signal_outputs;
  spikeloop_spike_output* spike_outputs;
  uint32_t signal_input_count;
  uint32_t spike_input_count;
  uint32_t signal_output_count;
  uint32_t spike_output_count;
} spikeloop_step;

enum { SPIKELOOP_SIGNAL = 0, SPIKELOOP_SPIKES = 1 }; /* kinds of port */
enum { SPIKELOOP_INPUT = 0, SPIKELOOP_OUTPUT = 1 };  /* directions of port */
enum { SPIKELOOP_WIDTH_FREE = 0, SPIKELOOP_WIDTH_FIXED = 1, SPIKELOOP_WIDTH_SAME = 2 };

/* A port. width_rule FIXED: width_value channels; SAME: as wide as the port with index
 * width_value; FREE: as the connection says. */
typedef struct spikeloop_port {
  const char* name;
  const char* text;
  uint32_t kind;
  uint32_t direction;
  uint32_t width_rule;
  uint32_t width_value;
} spikeloop_port;

enum {
  SPIKELOOP_NUMBER = 0,
  SPIKELOOP_INTEGER = 1,
  SPIKELOOP_BOOLEAN = 2,
  SPIKELOOP_TEXT = 3,
  SPIKELOOP_CHOICE = 4,
  SPIKELOOP_WEIGHTS = 5
}; /* types of parameter */

/* A parameter as data: checks, `describe` output and the reference page come from it. */
typedef struct spikeloop_parameter {
  const char* name;
  const char* unit;          /* "s", "Hz", ... or "" */
  const char* default_value; /* as one would write it; NULL: must be given */
  const char* choices;       /* "a|b|c" for SPIKELOOP_CHOICE, else NULL */
  const char* text;          /* one line */
  double minimum;            /* -INFINITY: none */
  double maximum;            /* INFINITY: none */
  uint32_t type;
  uint32_t reserved;
} spikeloop_parameter;

/* A weight table in compressed rows: row i (output channel) has entries row_start[i] ..
 * row_start[i+1]-1 of columns (input channels) and values. */
typedef struct spikeloop_weights {
  uint32_t rows;
  uint32_t columns;
  const uint64_t* row_start;
  const uint32_t* column;
  const double* value;
} spikeloop_weights;

/* A parameter's value; `number` holds numbers, integers and booleans alike. */
typedef struct spikeloop_value {
  const char* name;
  const char* text;
  const spikeloop_weights* weights;
  double number;
  int64_t integer;
  uint32_t type;
  uint32_t given; /* 1: the user wrote it; 0: the default */
} spikeloop_value;

struct spikeloop_node_class;

/* What a node is made from. widths[i] is the width of port i of its class. */
typedef struct spikeloop_setup {
  const char* name;
  uint64_t seed;
  const spikeloop_value* values;
  const uint32_t* widths;
  uint32_t value_count;
  uint32_t width_count;
  const struct spikeloop_node_class* node_class; /* the one whose create is called */
} spikeloop_setup;

typedef struct spikeloop_counter {
  const char* name; /* lives as long as the node */
  uint64_t value;
} spikeloop_counter;

/* A class of nodes. Functions that can fail write a sentence to error[error_size]; create then
 * returns NULL, step non-zero, counters SPIKELOOP_FAILED. None is called from two threads at once.
 */
#define SPIKELOOP_FAILED UINT32_MAX
typedef struct spikeloop_node_class {
  const char* name;
  const char* text;
  const spikeloop_port* ports;
  const spikeloop_parameter* parameters;
  uint32_t port_count;
  uint32_t parameter_count;
  void* (*create)(const spikeloop_setup* setup, char* error, uint64_t error_size);
  int (*step)(void* node, const spikeloop_step* step, char* error, uint64_t error_size);
  uint32_t (*counters)(void* node, spikeloop_counter* counters, uint32_t capacity, char* error,
                       uint64_t error_size);
  void (*destroy)(void* node);
} spikeloop_node_class;

/* What a plug-in exports under the name spikeloop_plugin_entry. The first three members never
 * move; they are checked before anything else is read. */
typedef struct spikeloop_plugin {
  uint64_t size;        /* sizeof(spikeloop_plugin) where the plug-in was built */
  uint64_t abi_version; /* SPIKELOOP_ABI_VERSION where the plug-in was built */
  const char* build;    /* SPIKELOOP_BUILD where the plug-in was built */
  const spikeloop_node_class* const* classes;
  uint64_t class_count;
} spikeloop_plugin;

typedef const spikeloop_plugin* (*spikeloop_plugin_entry_function)(void);

/* What the program does for a library. log may be called from any thread. */
enum { SPIKELOOP_LOG_INFO = 1, SPIKELOOP_LOG_WARNING = 2 };
typedef struct spikeloop_host {
  void (*log)(uint32_t level, const char* line);
} spikeloop_host;

/* A library that makes node classes of files which are no libraries (*.py) exports this under the
 * name spikeloop_loader_entry. The first three members are as those of spikeloop_plugin. */
typedef struct spikeloop_loader {
  uint64_t size;
  uint64_t abi_version;
  const char* build;
  /* Whether the file looks as if it defined node classes; runs nothing of it. */
  int (*defines_nodes)(const char* path);
  /* The same file gives the same classes again. They and the host live until the program ends. On
   * failure NULL, and in error the whole message with the path. */
  const spikeloop_plugin* (*load)(const char* path, const spikeloop_host* host, char* error,
                                  uint64_t error_size);
} spikeloop_loader;

typedef const spikeloop_loader* (*spikeloop_loader_entry_function)(void);

/* A plug-in defines it; SPIKELOOP_PLUGIN in plugin.hpp does that. Seen from outside even where
 * everything else is hidden. */
__attribute__((visibility("default"))) const spikeloop_plugin* spikeloop_plugin_entry(void);

#if defined(__x86_64__)
#define SPIKELOOP_BUILD "x86_64-linux"
#elif defined(__aarch64__)
#define SPIKELOOP_BUILD "aarch64-linux"
#else
#define SPIKELOOP_BUILD "unknown"
#endif

#ifdef __cplusplus
}
#endif
#endif
