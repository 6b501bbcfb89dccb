#include "services/cli/visible_bus.hpp"

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/message/texts.hpp"

namespace sealwatch::cli {
namespace {

void make_visible(std::string_view field, std::string& text) {
  const bool several_lines = !names_something(field);
  if (!is_visible(text, several_lines)) text = visible(text, several_lines);
}

template <class Content>
void make_visible(Content& content) {
  for_each_text("", content, [](std::string_view field, std::string& text) { make_visible(field, text); });
}

void make_visible(Message& message) {
  std::visit([](auto& content) { make_visible(content); }, message);
}

}  // namespace

std::vector<BusItem> VisibleBus::receive(std::chrono::milliseconds timeout, std::size_t most) {
  std::vector<BusItem> items = bus_->receive(timeout, most);
  for (BusItem& item : items) std::visit([](auto& content) { make_visible(content); }, item);
  return items;
}

}  // namespace sealwatch::cli
