// The virtual bench as a process.
#include "services/common/transport/dds_bus.hpp"
#include "services/virtual_bench/run_bench.hpp"

int main(int argc, char** argv) { return sealwatch::bench::run_bench(argc, argv, sealwatch::make_dds_bus); }
