// Sends one test so that it arrives once whatever is killed on the way: this program, the services, all of them.
// What makes it so: each block has an id that is the same whenever it is sent, and is kept until it is confirmed. Start
// it again after a kill; what had arrived is known by its id.
// Usage: sender ASSET_ID RECORDING_ID BLOCKS. Prints the id of each block once data_acquisition has it.
#include <cstdio>
#include <cstdlib>
#include <sealwatch/client/sender.hpp>
#include <string>

namespace {

/// One second at 200 Hz. A real one reads it from its own store, where it stays until it is confirmed.
sealwatch::RawSamples block_of(const std::string& asset, const std::string& recording, std::uint64_t number,
                               std::uint64_t blocks) {
  sealwatch::RawSamples block;
  block.asset_id = asset;
  block.source_id = "sender";
  block.recording_id = recording;
  block.block_number = number;
  block.boundary = number == 0            ? sealwatch::BlockBoundary::begin
                   : number + 1 == blocks ? sealwatch::BlockBoundary::end
                                          : sealwatch::BlockBoundary::inside;
  block.header.message_id = "raw_samples/" + asset + "/" + recording + "/" + std::to_string(number);
  sealwatch::Series position{"position", "m", 0.0, {}};
  for (int k = 0; k < 200; ++k) {
    block.samples.time_s.push_back(static_cast<double>(number) + k / 200.0);
    position.values.push_back(0.060 - 1.33e-3 * block.samples.time_s.back());
  }
  block.samples.channels.push_back(position);
  return block;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: sender ASSET_ID RECORDING_ID BLOCKS\n"), 2;
  sealwatch::client::Sender sender({.name = "sender"});
  const std::uint64_t blocks = std::strtoull(argv[3], nullptr, 10);
  for (std::uint64_t number = 0; number < blocks; ++number)
    if (const auto added = sender.add(block_of(argv[1], argv[2], number, blocks)); !added)
      return std::fprintf(stderr, "%s\n", added.error().describe().c_str()), 1;
  while (sender.unconfirmed() > 0) {
    if (const auto ran = sender.run_for(std::chrono::milliseconds(100)); !ran)
      return std::fprintf(stderr, "%s\n", ran.error().describe().c_str()), 1;
    for (const std::string& id : sender.take_confirmed()) std::printf("%s\n", id.c_str());
    std::fflush(stdout);
  }
}
