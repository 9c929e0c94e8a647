"""move_group of MoveIt's Panda that plans with Kinship: ros2 launch kinship_moveit panda_kinship.launch.py task:=pick_and_place

kinshipd runs beside it or where KINSHIP_SERVER says; without it the same node plans as ever.
"""
import os

import yaml
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from moveit_configs_utils import MoveItConfigsBuilder


def generate_launch_description():
    folder = os.path.join(get_package_share_directory("kinship_moveit"), "config")
    is_humble = os.environ.get("ROS_DISTRO") == "humble"
    with open(os.path.join(folder, "kinship_planning_humble.yaml" if is_humble else "kinship_planning.yaml")) as file:
        pipeline = yaml.safe_load(file)
    configuration = MoveItConfigsBuilder("moveit_resources_panda").planning_pipelines(pipelines=["ompl"]).to_moveit_configs()
    parameters = configuration.to_dict()
    # OMPL's configurations of planners stay where they are; around them stands Kinship's pipeline.
    parameters["ompl"].update(pipeline)
    return LaunchDescription([
        DeclareLaunchArgument("task", default_value="pick_and_place"),
        DeclareLaunchArgument("planner_plugin", default_value="ompl_interface/OMPLPlanner"),
        Node(package="moveit_ros_move_group", executable="move_group", output="screen",
             parameters=[parameters, os.path.join(folder, "panda_kinship.yaml"),
                         {"kinship.task": LaunchConfiguration("task"),
                          "kinship.planner_plugin": LaunchConfiguration("planner_plugin")}]),
    ])
