#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/node/node_option.h"

namespace lodeline {

/// A run of the estimator on live topics, as the nodes of ROS 1 and ROS 2 and lodeline_dds share it: the
/// choice of topics, messages as bytes in both directions, diagnostics, and the files of a run. The transport
/// of messages is the caller's. This header needs no other header of the library than node_option.h.
///
///     RosSession session(values, RosSession::Encoding::Cdr);
///     // subscribe to session.subscriptions(), advertise session.publications(), then
///     session.run(publish);       // in a thread, until close()
///     session.finish();
class RosSession {
 public:
  /// Serialization of messages. ROS 2's is little-endian CDR with its header of four bytes.
  enum class Encoding { Ros1, Cdr };
  using Bytes = std::vector<uint8_t>;

  struct Subscription {
    std::string sensor, topic;
    std::vector<std::string> types;  ///< that it may have, e.g. "sensor_msgs/Imu"; the preferred one first
    bool is_reliable = false;        ///< otherwise best effort
    int depth = 0;                   ///< most messages that wait
  };
  struct Publication {
    std::string topic;  ///< in the node's namespace, or absolute with a slash in front
    std::string type;
    int depth = 0;
    /// Whether subscribers that come later get the last message (latched; transient local).
    bool is_latched = false;
  };
  /// Sends a message on a topic, by its place in publications(). Called from the thread of run() and from
  /// that of publishDiagnostics().
  using Publish = std::function<void(size_t publication, Bytes message)>;

  /// Reads the rig and checks the options, see nodeOptions(). Throws UsageError and InputError.
  RosSession(const OptionValues& options, Encoding encoding);
  ~RosSession();
  RosSession(const RosSession&) = delete;
  RosSession& operator=(const RosSession&) = delete;

  const std::vector<Subscription>& subscriptions() const;
  const std::vector<Publication>& publications() const;
  /// Sensors and topics in one line.
  std::string description() const;

  /// Takes a message of a topic, by its place in subscriptions(). `type`: e.g. "sensor_msgs/Imu"; `md5sum`:
  /// ROS 1's checksum of its definition. Any thread may call this; it does not wait.
  void receive(size_t subscription, const std::string& type, Bytes message, const std::string& md5sum = {});
  /// Counts messages that the transport lost.
  void addLost(size_t subscription, uint64_t messages);
  /// States why nothing can be received on a topic, for diagnostics.
  void addProblem(size_t subscription, const std::string& problem);

  /// Estimates until close(); messages that wait are worked off first. Returns false where it was closed
  /// before all sensors were heard. Throws InputError and UsageError.
  bool run(const Publish& publish);
  /// Ends run(). Any thread may call this.
  void close();
  /// Completes the files after run(), and returns a summary for the user.
  std::string finish();

  /// Publishes the state of the run; called about once per second. `now_ns`: time since 1970.
  void publishDiagnostics(int64_t now_ns, const Publish& publish);
  /// Messages of a topic so far: received, lost, and of no use.
  struct Traffic {
    uint64_t received = 0, lost = 0, unusable = 0;
  };
  Traffic traffic(size_t subscription) const;

 private:
  class Content;
  std::unique_ptr<Content> content_;
};

}  // namespace lodeline
