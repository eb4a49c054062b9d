#include "lodeline/output/live/event_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace lodeline {
namespace {

TEST(EventQueue, GivesTextsInTheirOrder) {
  EventQueue queue(8);
  queue.push("a");
  queue.push("b");
  EXPECT_EQ(queue.pop(), "a");
  EXPECT_EQ(queue.pop(), "b");
}

TEST(EventQueue, DropsTheOldestWhenFull) {
  EventQueue queue(3);
  for (const char* text : {"a", "b", "c", "d", "e"}) queue.push(text);
  EXPECT_EQ(queue.pop(), "c");
  EXPECT_EQ(queue.pop(), "d");
  EXPECT_EQ(queue.pop(), "e");
}

TEST(EventQueue, GivesWhatIsLeftAfterItWasClosed) {
  EventQueue queue(3);
  queue.push("a");
  queue.close();
  EXPECT_EQ(queue.pop(), "a");
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(EventQueue, WakesWhoWaits) {
  EventQueue queue(3);
  std::thread writer([&queue] { queue.push("a"); });
  EXPECT_EQ(queue.pop(), "a");
  writer.join();
  std::thread closer([&queue] { queue.close(); });
  EXPECT_EQ(queue.pop(), std::nullopt);
  closer.join();
}

}  // namespace
}  // namespace lodeline
