R"c(
/* Tables of an arm, as they stand behind the types; of them the text needs declarations alone. */
extern const double arm_limits_[2 * ARM_JOINTS], arm_nominal_rows_[7 * ARM_JOINTS];
extern const arm_arm_ arm_identified_;
#if HAS_CONTROLLER
extern const double arm_factors_[ARM_CHAIN_ * ARM_JOINTS], arm_zeros_[ARM_CHAIN_];
#endif
#if HAS_MOTORS
extern const double arm_motor_effects_[ARM_CHAIN_ * ARM_CHAIN_], arm_motor_angles_[ARM_CHAIN_ * ARM_CHAIN_];
extern const double arm_motor_zeros_[ARM_CHAIN_];
#endif
#if HAS_PRISMATIC
extern const int arm_prismatic_[ARM_JOINTS];
#endif
#if HAS_FALLBACK
extern const arm_arm_ arm_outside_;
extern const arm_coverage_ arm_coverage_of_model_;
#endif
#if HAS_LEARNED
extern const double arm_feature_offset_[ARM_FEATURES_], arm_feature_factor_[ARM_FEATURES_], arm_output_offset_[3];
extern const double arm_nodes_[ARM_NODES_ * (ARM_FEATURES_ + 4)];
extern const arm_coverage_ arm_coverage_of_learned_;
#endif
)c"
