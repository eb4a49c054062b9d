"""Starts the component in a container: ros2 launch lodeline_ros2 lodeline.launch.py rig:=/path/rig.yaml"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import ComposableNodeContainer
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def text(name):
    """The value of a launch argument as a text, also where it looks like a number."""
    return ParameterValue(LaunchConfiguration(name), value_type=str)


def generate_launch_description():
    defaults = PathJoinSubstitution([FindPackageShare("lodeline_ros2"), "config", "lodeline.yaml"])
    arguments = [
        DeclareLaunchArgument("rig", description="file that describes the rig, with the topic of each sensor"),
        DeclareLaunchArgument("output", default_value="", description="folder for the results; none where empty"),
        DeclareLaunchArgument("config", default_value=defaults, description="parameters of the node (YAML)"),
        DeclareLaunchArgument("namespace", default_value="", description="namespace of the node"),
    ]
    component = ComposableNode(
        package="lodeline_ros2",
        plugin="lodeline::LodelineComponent",
        name="lodeline",
        namespace=LaunchConfiguration("namespace"),
        parameters=[LaunchConfiguration("config"), {"rig": text("rig"), "output": text("output")}],
    )
    container = ComposableNodeContainer(
        name="lodeline_container",
        namespace=LaunchConfiguration("namespace"),
        package="rclcpp_components",
        executable="component_container",
        composable_node_descriptions=[component],
        output="screen",
    )
    return LaunchDescription([*arguments, container])
