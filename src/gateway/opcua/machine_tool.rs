//! The machine in the address space: an object of `MachineToolType`, and in its own namespace every data item of the
//! control. Each variable is bound to what the control tells.
//! Source: OPC 40501-1 (machine tools) 1.02, OPC 40001-1 (machinery).

use opcua::nodes::{EventNotifier, ObjectBuilder, ObjectTypeBuilder, VariableBuilder};
use opcua::server::address_space::AddressSpace;
use opcua::types::{
    DataTypeId, EUInformation, ExtensionObject, LocalizedText, NodeId, ObjectId, ObjectTypeId, QualifiedName, Range,
    ReferenceTypeId, VariableTypeId, Variant,
};

use super::adapter_state::{AdapterState, ProgramCourse};
use super::node_builder::{
    BoundVariable, ChildOf, Namespace, NamespaceIndices, NodeBuilder, Read, TypeNumber, VariableSpec,
};
use super::production_plan::ProductionPlan;
use crate::link::condition::FAULT;
use crate::link::data_item::{Category, DataItem, all_data_items};

/// Numbers of the node sets.
mod numbers {
    use super::Namespace::{MachineTool, Machinery};
    use super::TypeNumber;

    pub const MACHINES_FOLDER: TypeNumber = (Machinery, 1001);
    pub const MACHINE_TOOL: TypeNumber = (MachineTool, 13);
    pub const IDENTIFICATION: TypeNumber = (MachineTool, 11);
    pub const MONITORING: TypeNumber = (MachineTool, 14);
    pub const MACHINE_OPERATION: TypeNumber = (MachineTool, 26);
    pub const CHANNEL: TypeNumber = (MachineTool, 16);
    pub const CHANNEL_MODIFIERS: TypeNumber = (MachineTool, 33);
    pub const SPINDLE: TypeNumber = (MachineTool, 22);
    pub const NOTIFICATION: TypeNumber = (MachineTool, 7);
    pub const MESSAGES: TypeNumber = (MachineTool, 38);
    pub const ALERT: TypeNumber = (MachineTool, super::ALERT_NUMBER);
    pub const NOTIFICATION_EVENT: TypeNumber = (MachineTool, 35);
    pub const PRODUCTION: TypeNumber = (MachineTool, 21);
    pub const ACTIVE_PROGRAM: TypeNumber = (MachineTool, 32);
    pub const PROGRAM_STATE: TypeNumber = (MachineTool, 15);
    pub const STATISTICS: TypeNumber = (MachineTool, 20);
    pub const EQUIPMENT: TypeNumber = (MachineTool, 12);
    pub const TOOL_LIST: TypeNumber = (MachineTool, 44);
    pub const TOOL: TypeNumber = (MachineTool, 50);
    pub const OPERATION_MODE: TypeNumber = (MachineTool, 65);
    pub const CHANNEL_STATE: TypeNumber = (MachineTool, 64);
    pub const CHANNEL_MODE: TypeNumber = (MachineTool, 67);
    pub const TOOL_LOCKED: TypeNumber = (MachineTool, 66);
    pub const TOOL_MANAGEMENT: TypeNumber = (MachineTool, 69);
    /// Nodes of the states of a program, in the order of [`super::PROGRAM_STATES`].
    pub const PROGRAM_STATES: [TypeNumber; 5] =
        [(MachineTool, 5039), (MachineTool, 5041), (MachineTool, 5038), (MachineTool, 5040), (MachineTool, 5037)];
}

/// States of a program by their numbers.
const PROGRAM_STATES: [&str; 5] = ["Initializing", "Running", "Ended", "Interrupted", "Aborted"];
/// `AlertType` in the namespace of machine tools.
pub const ALERT_NUMBER: u32 = 39;
/// The concrete type of the messages: that of the specification is abstract.
pub const MESSAGE_EVENT_TYPE: &str = "MessageEventType";

/// The machine in the address space.
pub struct MachineNodes {
    /// The variables that follow the control.
    pub variables: Vec<BoundVariable>,
    /// The machine.
    pub root: NodeId,
    /// The object that tells events.
    pub messages: NodeId,
    /// Type of the messages, and the one of the specification above it.
    pub message_types: [NodeId; 2],
    /// Type of the alarms.
    pub alert_type: NodeId,
    /// The orders.
    pub plan: ProductionPlan,
}

/// Creates the machine that a control has told of.
pub fn create(space: &mut AddressSpace, indices: NamespaceIndices, state: &AdapterState) -> MachineNodes {
    let mut building = NodeBuilder { space, indices, variables: Vec::new() };
    let own = indices.of(Namespace::Own);
    let root = NodeId::new(own, state.identity.uuid.clone());
    let name = QualifiedName::new(own, state.identity.uuid.clone());
    ObjectBuilder::new(&root, name, state.identity.uuid.clone())
        .organized_by(indices.node(numbers::MACHINES_FOLDER))
        .has_type_definition(indices.node(numbers::MACHINE_TOOL))
        .insert(building.space);
    building.identification(&root, state);
    building.monitoring(&root);
    let plan = building.production(&root);
    building.equipment(&root, state);
    let messages = building.notification(&root);
    building.data_items(&root, state);
    let message_types = [building.message_type(), indices.node(numbers::NOTIFICATION_EVENT)];
    let alert_type = indices.node(numbers::ALERT);
    MachineNodes { variables: building.variables, root, messages, message_types, alert_type, plan }
}

impl NodeBuilder<'_> {
    /// A percentage that follows a data item.
    fn percentage(&mut self, parent: &NodeId, name: &'static str, item: &'static str, most: f64) {
        let row = VariableSpec::new(ChildOf::Component, Namespace::MachineTool, name, DataTypeId::Double)
            .of(VariableTypeId::AnalogUnitRangeType);
        let id = self.bound(parent, row, move |state| state.number(item).map(Variant::Double));
        self.fixed(&id, engineering_units(), ExtensionObject::from_message(unit("PERCENT")));
        let row = VariableSpec::new(ChildOf::Property, Namespace::Ua, "EURange", DataTypeId::Range);
        self.fixed(&id, row, ExtensionObject::from_message(Range { low: 0.0, high: most }));
    }

    fn flag(&mut self, parent: &NodeId, name: &'static str, item: &'static str) {
        let row = VariableSpec::new(ChildOf::Component, Namespace::MachineTool, name, DataTypeId::Boolean);
        self.bound(parent, row, move |state| Some(Variant::Boolean(state.text(item)? == "ON")));
    }

    fn identification(&mut self, root: &NodeId, state: &AdapterState) {
        let at = self.object(root, ChildOf::AddIn, (Namespace::Devices, "Identification"), numbers::IDENTIFICATION);
        let identity = &state.identity;
        let texts = [("Manufacturer", identity.manufacturer.as_str()), ("Model", identity.description.as_str())];
        for (name, text) in texts {
            let row = VariableSpec::new(ChildOf::Property, Namespace::Devices, name, DataTypeId::LocalizedText);
            self.fixed(&at, row, LocalizedText::new("en", text));
        }
        let uri = format!("urn:kt830:{}", identity.uuid);
        for (name, text) in [("SerialNumber", identity.serial_number.clone()), ("ProductInstanceUri", uri)] {
            let row = VariableSpec::new(ChildOf::Property, Namespace::Devices, name, DataTypeId::String);
            self.fixed(&at, row, text);
        }
    }

    fn monitoring(&mut self, root: &NodeId) {
        let at = self.component(root, "Monitoring", numbers::MONITORING);
        let machine = self.component(&at, "MachineTool", numbers::MACHINE_OPERATION);
        let row = self.enumeration("OperationMode", numbers::OPERATION_MODE);
        self.bound(&machine, row, |state| Some(Variant::Int32(operation_mode(state.text("mode")?))));
        self.percentage(&machine, "FeedOverride", "feed_override", 150.0);
        let channel = self.element(&at, "Channel1", numbers::CHANNEL);
        let row = self.enumeration("ChannelState", numbers::CHANNEL_STATE);
        self.bound(&channel, row, |state| Some(Variant::Int32(channel_state(state.text("execution")?))));
        let row = self.enumeration("ChannelMode", numbers::CHANNEL_MODE);
        self.bound(&channel, row, |state| Some(Variant::Int32(channel_mode(state.text("mode")?))));
        self.percentage(&channel, "FeedOverride", "feed_override", 150.0);
        self.percentage(&channel, "RapidOverride", "rapid_override", 100.0);
        let modifiers = self.component(&channel, "ChannelModifiers", numbers::CHANNEL_MODIFIERS);
        let flags = [
            ("DryRun", "dry_run"),
            ("OptionalStop", "optional_stop"),
            ("SingleStep", "single_block"),
            ("TestMode", "machine_lock"),
        ];
        for (name, item) in flags {
            self.flag(&modifiers, name, item);
        }
        let spindle = self.element(&at, "Spindle1", numbers::SPINDLE);
        let row = VariableSpec::new(ChildOf::Component, Namespace::MachineTool, "IsRotating", DataTypeId::Boolean);
        self.bound(&spindle, row, |state| {
            // Measured where it is: a wheel runs down for minutes after it was switched off.
            let by_output = || Some(state.text("spindle_power")? == "ON");
            state.number("spindle_speed").map(|speed| speed.abs() >= 0.5).or_else(by_output).map(Variant::Boolean)
        });
        self.percentage(&spindle, "Override", "spindle_override", 150.0);
    }

    /// A monitored element with its name.
    fn element(&mut self, parent: &NodeId, name: &str, kind: TypeNumber) -> NodeId {
        let id = self.component(parent, name, kind);
        let row = VariableSpec::new(ChildOf::Property, Namespace::MachineTool, "Name", DataTypeId::String);
        self.fixed(&id, row, name.to_owned());
        id
    }

    fn enumeration(&self, name: &'static str, kind: TypeNumber) -> VariableSpec {
        VariableSpec::new(ChildOf::Component, Namespace::MachineTool, name, self.indices.node(kind))
    }

    fn production(&mut self, root: &NodeId) -> ProductionPlan {
        let at = self.component(root, "Production", numbers::PRODUCTION);
        let program = self.component(&at, "ActiveProgram", numbers::ACTIVE_PROGRAM);
        let row = VariableSpec::new(ChildOf::Property, Namespace::MachineTool, "Name", DataTypeId::String);
        self.bound(&program, row, |state| state.text("program").map(Variant::from));
        let row = VariableSpec::new(ChildOf::Property, Namespace::Ua, "NumberInList", DataTypeId::UInt16);
        self.fixed(&program, row, 0_u16);
        let row = VariableSpec::new(ChildOf::Component, Namespace::MachineTool, "JobIdentifier", DataTypeId::String);
        self.bound(&program, row, |state| state.text("order").map(Variant::from));
        let machine = self.component(&program, "State", numbers::PROGRAM_STATE);
        let row = VariableSpec::new(ChildOf::Component, Namespace::Ua, "CurrentState", DataTypeId::LocalizedText)
            .of(VariableTypeId::FiniteStateVariableType);
        let current = self.bound(&machine, row, |state| {
            Some(Variant::from(LocalizedText::new("en", PROGRAM_STATES[program_state(state)?])))
        });
        let nodes = numbers::PROGRAM_STATES.map(|state| self.indices.node(state));
        let row = VariableSpec::new(ChildOf::Property, Namespace::Ua, "Id", DataTypeId::NodeId);
        self.bound(&current, row, move |state| Some(Variant::from(nodes[program_state(state)?].clone())));
        let row = VariableSpec::new(ChildOf::Property, Namespace::Ua, "Number", DataTypeId::UInt32);
        self.bound(&current, row, |state| Some(Variant::UInt32(program_state(state)? as u32)));
        let statistics = self.component(&at, "Statistics", numbers::STATISTICS);
        let row = VariableSpec::new(
            ChildOf::Component,
            Namespace::MachineTool,
            "PartsProducedInLifetime",
            DataTypeId::UInt32,
        );
        self.bound(&statistics, row, |state| Some(Variant::UInt32(state.number("parts_all")? as u32)));
        ProductionPlan::create(self, &at)
    }

    /// The wheel is the one tool; a lathe tells none.
    fn equipment(&mut self, root: &NodeId, state: &AdapterState) {
        let at = self.component(root, "Equipment", numbers::EQUIPMENT);
        if state.text("wheel_diameter").is_none() {
            return;
        }
        let tools = self.component(&at, "Tools", numbers::TOOL_LIST);
        let wheel = self.component(&tools, "Wheel", numbers::TOOL);
        let row = VariableSpec::new(ChildOf::Property, Namespace::MachineTool, "Name", DataTypeId::String);
        self.fixed(&wheel, row, "grinding wheel");
        let row =
            VariableSpec::new(ChildOf::Component, Namespace::MachineTool, "ControlIdentifier1", DataTypeId::UInt32);
        self.fixed(&wheel, row, 1_u32);
        // Known by its number; never locked by the control, which has no word for it.
        let row = self.enumeration("ControlIdentifierInterpretation", numbers::TOOL_MANAGEMENT);
        self.fixed(&wheel, row, 0_i32);
        let row = VariableSpec::new(ChildOf::Component, Namespace::MachineTool, "Locked", DataTypeId::Boolean);
        let locked = self.fixed(&wheel, row, false);
        let reason = self.indices.node(numbers::TOOL_LOCKED);
        let row = VariableSpec::new(ChildOf::Property, Namespace::MachineTool, "ReasonForLocking", reason);
        self.fixed(&locked, row, 0_i32);
        let row = VariableSpec::new(ChildOf::Component, Namespace::Own, "Diameter", DataTypeId::Double);
        let diameter = self.bound(&wheel, row, |state| state.number("wheel_diameter").map(Variant::Double));
        self.fixed(&diameter, engineering_units(), ExtensionObject::from_message(unit("MILLIMETER")));
    }

    fn notification(&mut self, root: &NodeId) -> NodeId {
        let at = self.component(root, "Notification", numbers::NOTIFICATION);
        let id = self.child_id(&at, "Messages");
        ObjectBuilder::new(&id, QualifiedName::new(self.indices.of(Namespace::MachineTool), "Messages"), "Messages")
            .component_of(at.clone())
            .has_type_definition(self.indices.node(numbers::MESSAGES))
            .event_notifier(EventNotifier::SUBSCRIBE_TO_EVENTS)
            .insert(self.space);
        self.space.insert_reference(&NodeId::from(ObjectId::Server), &id, ReferenceTypeId::HasNotifier);
        // For a client that comes when an alarm is there already: events are told once.
        let row = VariableSpec::new(ChildOf::Component, Namespace::Own, "ActiveAlarms", DataTypeId::String);
        let alarms = self.bound(&at, row, |state| {
            let texts: Vec<String> = state
                .alarms()
                .map(|alarm| format!("{} {} {}", alarm.number, level(alarm.is_fault), alarm.text))
                .collect();
            Some(Variant::from(texts))
        });
        if let Some(opcua::nodes::NodeType::Variable(alarms)) = self.space.find_mut(&alarms) {
            alarms.set_value_rank(1);
        }
        id
    }

    /// Every data item with its id as its name.
    fn data_items(&mut self, root: &NodeId, state: &AdapterState) {
        let id = self.child_id(root, "DataItems");
        ObjectBuilder::new(&id, QualifiedName::new(self.indices.of(Namespace::Own), "DataItems"), "DataItems")
            .component_of(root.clone())
            .has_type_definition(ObjectTypeId::FolderType)
            .insert(self.space);
        for item in all_data_items().filter(|item| state.items().any(|told| told == item.id())) {
            self.data_item(&id, &item);
        }
    }

    fn data_item(&mut self, folder: &NodeId, item: &DataItem) {
        let name = item.id();
        let id = self.child_id(folder, &name);
        let (data_type, units) = match item.category {
            Category::Sample(units) | Category::EventWithUnits(units) => (DataTypeId::Double, units),
            Category::Event => (DataTypeId::String, ""),
        };
        VariableBuilder::new(
            &id,
            QualifiedName::new(self.indices.of(Namespace::Own), name.clone()),
            LocalizedText::new("en", item.text.en),
        )
        .component_of(folder.clone())
        .has_type_definition(VariableTypeId::BaseDataVariableType)
        .data_type(data_type)
        .value(Variant::Empty)
        .insert(self.space);
        let is_number = !units.is_empty();
        if is_number {
            self.fixed(&id, engineering_units(), ExtensionObject::from_message(unit(units)));
        }
        let read: Read = Box::new(move |state| match is_number {
            true => state.number(&name).map(Variant::Double),
            false => state.text(&name).map(Variant::from),
        });
        self.variables.push(BoundVariable { id, read });
    }

    fn message_type(&mut self) -> NodeId {
        let own = self.indices.of(Namespace::Own);
        let id = NodeId::new(own, MESSAGE_EVENT_TYPE);
        ObjectTypeBuilder::new(&id, QualifiedName::new(own, MESSAGE_EVENT_TYPE), MESSAGE_EVENT_TYPE)
            .subtype_of(self.indices.node(numbers::NOTIFICATION_EVENT))
            .insert(self.space);
        id
    }
}

fn engineering_units() -> VariableSpec {
    VariableSpec::new(ChildOf::Property, Namespace::Ua, "EngineeringUnits", DataTypeId::EUInformation)
}

/// A unit of MTConnect by its number of UN/CEFACT recommendation 20, which is made of the signs of its code.
fn unit(name: &str) -> EUInformation {
    let (code, sign) = match name {
        "PERCENT" => ("P1", "%"),
        "MILLIMETER" => ("MMT", "mm"),
        "MILLIMETER/SECOND" => ("C16", "mm/s"),
        "REVOLUTION/MINUTE" => ("RPM", "r/min"),
        "SECOND" => ("SEC", "s"),
        other => ("", other),
    };
    EUInformation {
        namespace_uri: "http://www.opcfoundation.org/UA/units/un/cefact".into(),
        unit_id: code.bytes().fold(0, |number, sign| number << 8 | i32::from(sign)),
        display_name: sign.into(),
        description: name.into(),
    }
}

/// The word of the level of an alarm.
const fn level(is_fault: bool) -> &'static str {
    if is_fault { FAULT } else { "WARNING" }
}

/// `MachineOperationMode`: manual 0, automatic 1, other 5.
fn operation_mode(mode: &str) -> i32 {
    match mode {
        "AUTOMATIC" => 1,
        "MANUAL" | "MANUAL_DATA_INPUT" => 0,
        _ => 5,
    }
}

/// `ChannelState`: active 0, interrupted 1, reset 2.
fn channel_state(execution: &str) -> i32 {
    match execution {
        "ACTIVE" => 0,
        "READY" | "PROGRAM_COMPLETED" => 2,
        _ => 1,
    }
}

/// `ChannelMode`: automatic 0, MDI 1, jog 2, other 7.
fn channel_mode(mode: &str) -> i32 {
    match mode {
        "AUTOMATIC" => 0,
        "MANUAL_DATA_INPUT" => 1,
        "MANUAL" => 2,
        _ => 7,
    }
}

/// State of the program, by its place in [`PROGRAM_STATES`].
fn program_state(state: &AdapterState) -> Option<usize> {
    Some(match state.program()? {
        ProgramCourse::Loaded => 0,
        ProgramCourse::Runs => 1,
        ProgramCourse::Ended => 2,
        ProgramCourse::Interrupted => 3,
        ProgramCourse::Aborted => 4,
    })
}
